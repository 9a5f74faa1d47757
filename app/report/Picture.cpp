#include "app/report/Picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "app/report/AsideFile.h"

namespace app {

void writePng(const Picture& picture, const std::filesystem::path& file) {
    const auto needed =
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) * 4;
    if (picture.width < 1 || picture.height < 1 || picture.rgba.size() != needed)
        throw std::runtime_error("there are no pixels to write to '" + file.string() +
                                 "'; draw something first.");
    const auto fail = [&](const std::string& cause) {
        throw std::runtime_error("cannot write the picture '" + file.string() + "' (" + cause +
                                 "); make room or choose another place.");
    };
    // Encoded in memory: the library's own writing does not notice a full disk.
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    auto output = OIIO::ImageOutput::create("png");
    if (!output) fail(OIIO::geterror());
    OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("compression", "zip:3");  // a third of the default's time for a few percent more bytes
    if (!output->set_ioproxy(&memory) || !output->open(file.filename().string(), spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, picture.rgba.data(), 4) || !output->close())
        fail(output->geterror());
    writeTextFile(file, std::string(bytes.begin(), bytes.end()));
}

}  // namespace app
