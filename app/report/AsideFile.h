#pragma once

#include <filesystem>
#include <string>

namespace app {

/// A file that is written under another name beside its own (`NAME.partial.EXT`) and takes its name only when
/// it is whole. The constructor makes the folder; throws std::runtime_error naming it when that fails.
class AsideFile {
  public:
    explicit AsideFile(std::filesystem::path file);
    /// Removes what was written aside unless `commit` came first.
    ~AsideFile();
    AsideFile(const AsideFile&) = delete;
    AsideFile& operator=(const AsideFile&) = delete;

    const std::filesystem::path& file() const { return file_; }    ///< the name it will have
    const std::filesystem::path& aside() const { return aside_; }  ///< where to write now
    /// Gives the file its name, over an older one. Throws std::runtime_error naming both when that fails.
    void commit();

  private:
    std::filesystem::path file_;
    std::filesystem::path aside_;
    bool committed_ = false;
};

/// Throws, before any work is done for it, what writing this file would throw: std::runtime_error naming the
/// file and the cause. Leaves the folder made, and no file.
void requireWritable(const std::filesystem::path& file);

/// Writes a whole file, text or any other bytes, that way. Throws std::runtime_error naming the file and the
/// cause.
void writeTextFile(const std::filesystem::path& file, const std::string& text);

}  // namespace app
