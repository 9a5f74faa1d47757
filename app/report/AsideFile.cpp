#include "app/report/AsideFile.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace app {

namespace {

std::filesystem::path asideOf(const std::filesystem::path& file) {
    std::filesystem::path aside = file;
    aside.replace_filename(file.stem().string() + ".partial" + file.extension().string());
    return aside;
}

}  // namespace

AsideFile::AsideFile(std::filesystem::path file) : file_(std::move(file)), aside_(asideOf(file_)) {
    if (!file_.has_filename())
        throw std::runtime_error("'" + file_.string() + "' names no file; give a file name.");
    const std::filesystem::path folder = file_.parent_path();
    std::error_code error;
    if (!folder.empty()) std::filesystem::create_directories(folder, error);
    if (error)
        throw std::runtime_error("cannot make the folder '" + folder.string() + "' (" + error.message() +
                                 "); choose another place or mend its permissions.");
}

AsideFile::~AsideFile() {
    std::error_code ignored;
    if (!committed_) std::filesystem::remove(aside_, ignored);
}

void AsideFile::commit() {
    std::error_code error;
    std::filesystem::rename(aside_, file_, error);
    if (error)
        throw std::runtime_error("cannot rename '" + aside_.string() + "' to '" + file_.string() + "' (" +
                                 error.message() + "); mend the folder's permissions.");
    committed_ = true;
}

void requireWritable(const std::filesystem::path& file) {
    const AsideFile aside(file);
    std::error_code ignored;
    const bool folderInTheWay = std::filesystem::is_directory(file, ignored);
    if (!folderInTheWay && std::ofstream(aside.aside(), std::ios::binary | std::ios::trunc)) return;
    throw std::runtime_error("cannot write '" + file.string() + "' (" +
                             std::strerror(folderInTheWay ? EISDIR : errno) +
                             "); mend the permissions or choose another place.");
}

void writeTextFile(const std::filesystem::path& file, const std::string& text) {
    AsideFile aside(file);
    std::ofstream out(aside.aside(), std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    if (!out)
        throw std::runtime_error("cannot write '" + file.string() + "' (" + std::strerror(errno) +
                                 "); make room or choose another place.");
    aside.commit();
}

}  // namespace app
