#include "app/report/Picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/report/AsideFile.h"

namespace app {

std::vector<unsigned char> encodePicture(const Picture& picture, PictureFormat format) {
    const auto needed = static_cast<std::size_t>(std::max(picture.width, 0)) *
                        static_cast<std::size_t>(std::max(picture.height, 0)) * 4;
    if (picture.width < 1 || picture.height < 1 || picture.rgba.size() != needed)
        throw std::runtime_error("there are no pixels to write; draw something first.");
    const std::string name = format == PictureFormat::png ? "png" : "jpg";
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    auto output = OIIO::ImageOutput::create(name);
    if (!output) throw std::runtime_error(OIIO::geterror());
    OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    // Of PNG a third of the default's time for a few percent more bytes; of JPEG colours at full resolution.
    spec.attribute("compression", format == PictureFormat::png ? "zip:3" : "jpeg:92");
    if (format == PictureFormat::jpeg) spec.attribute("jpeg:subsampling", "4:4:4");
    if (!output->set_ioproxy(&memory) || !output->open("picture." + name, spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, picture.rgba.data(), 4) || !output->close())
        throw std::runtime_error(output->geterror());
    return bytes;
}

std::string base64(const std::vector<unsigned char>& bytes) {
    static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const std::uint32_t three = static_cast<std::uint32_t>(bytes[i]) << 16 |
                                    (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8 : 0u) |
                                    (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0u);
        text += letters[three >> 18];
        text += letters[three >> 12 & 63];
        text += left > 1 ? letters[three >> 6 & 63] : '=';
        text += left > 2 ? letters[three & 63] : '=';
    }
    return text;
}

std::string dataUrl(const Picture& picture, PictureFormat format) {
    return std::string("data:image/") + (format == PictureFormat::png ? "png" : "jpeg") + ";base64," +
           base64(encodePicture(picture, format));
}

void writePng(const Picture& picture, const std::filesystem::path& file) {
    // Encoded in memory: the library's own writing does not notice a full disk.
    std::vector<unsigned char> bytes;
    try {
        bytes = encodePicture(picture, PictureFormat::png);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error("cannot write the picture '" + file.string() + "': " + error.what());
    }
    writeTextFile(file, std::string(bytes.begin(), bytes.end()));
}

}  // namespace app
