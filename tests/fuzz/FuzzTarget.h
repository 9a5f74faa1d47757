#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace fuzz {

/// What a reader of files is fed with: any bytes. It may refuse them with a std::runtime_error or
/// std::invalid_argument, as it promises; whatever else leaves it ends the program, and so does what a
/// sanitizer finds.
void feed(std::span<const std::uint8_t> bytes, const std::string& ending,
          const std::function<void(const std::filesystem::path&)>& read);

}  // namespace fuzz

/// libFuzzer's entry, defined by each target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
