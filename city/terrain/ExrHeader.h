#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace city {

/// What the header of an OpenEXR file tells.
struct ExrHeader {
    /// OpenEXR's own numbers of them.
    enum class Compression : std::uint8_t { none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab };

    std::string fault;  ///< why OpenEXR must not be given the file, a clause; empty when nothing is wrong
    std::int64_t width = 0, height = 0;  ///< of the data window, 1 to 65536 each
    std::uint64_t pixelBytes = 0;        ///< of a pixel of all channels, 1 at least
    Compression compression = Compression::none;
};

/// Reads the header without OpenEXR, which believes what it says: it makes room for strings of 2 GiB, for
/// previews and line tables of any size, before it looks whether the file goes on. Found at fault: a header
/// that does not end within the file's first 4 MiB, attributes that reach out of it or have not the size of
/// their type, several parts or deep data, windows wider or higher than 65536, tables of blocks that do not
/// fit into the file, and more pixels than the file can hold (1376 times its size: deflate shrinks by 1032 at
/// most, says zlib's documentation, and PXR24 drops every fourth byte before that), none of which the files
/// that this project writes or takes have. Never throws but for want of memory. Cost: the header's bytes.
///
/// Source: "OpenEXR File Layout", openexr.com.
ExrHeader readExrHeader(const std::filesystem::path& file);

}  // namespace city
