// libFuzzer on one reader: clearway_fuzz --reader=NAME [options of libFuzzer] [CORPUS...]
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "fuzz_readers.hpp"  // made by CMake: the files' names and functions

namespace {

decltype(clearway::fuzz::readers[0].read) chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view flag = "--reader=";  // libFuzzer hands on what begins with two dashes, unread
  for (int i = 1; i < *argc; ++i) {
    const std::string_view word = (*argv)[i];
    if (!word.starts_with(flag)) continue;
    for (const auto& reader : clearway::fuzz::readers)
      if (word.substr(flag.size()) == reader.name) chosen = reader.read;
  }
  if (chosen != nullptr) return 0;
  std::fputs("clearway_fuzz: expected --reader=NAME, of a file tests/fuzz/*/NAME_fuzz.cpp\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return chosen(data, size);
}
