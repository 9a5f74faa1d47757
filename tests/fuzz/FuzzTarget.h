#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace fuzz {

/// A reader of files may refuse any bytes with a std::runtime_error or std::invalid_argument, as it promises;
/// whatever else leaves it ends the program, and so does what a sanitizer finds.
void orRefuse(const std::function<void()>& read);

/// Feeds a reader of files with any bytes. `name`: of the file, in a folder of this process alone. The file
/// stays there until the next call.
void feed(std::span<const std::uint8_t> bytes, const std::string& name,
          const std::function<void(const std::filesystem::path&)>& read);

/// True for one input in `count`, the same ones in every run: for what costs too much to be done with all.
bool oneIn(std::uint64_t count, std::span<const std::uint8_t> bytes);

}  // namespace fuzz

/// libFuzzer's entry, defined by each target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
