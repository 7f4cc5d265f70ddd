#pragma once

// What every fuzzer shares: input of any kind is read, or refused in one sentence by an exception that users
// see as such. Anything else (another exception, a message of several lines or of a page) is a find.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mapping/files/map_file.hpp"

namespace clearway::fuzz {

/// The input as a file, for readers that open one. The same name each time; gone with the process.
class InputFile {
 public:
  explicit InputFile(const std::string& extension)
      : path_(std::filesystem::temp_directory_path() /
              ("clearway_fuzz_" + std::to_string(::getpid()) + extension)) {}
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::filesystem::path& write(std::string_view bytes) const {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A folder for readers that open what lies in one; gone with the process.
class InputFolder {
 public:
  explicit InputFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("clearway_fuzz_" + std::to_string(::getpid()) + "_" + name)) {
    std::filesystem::create_directories(path_);
  }
  ~InputFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path write(const std::string& file, std::string_view bytes) const {
    std::ofstream(path_ / file, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / file;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline void require_sentence(const std::exception& error) {
  const std::string_view text = error.what();
  bool is_sentence = !text.empty() && text.size() <= 600;
  for (const char c : text) is_sentence = is_sentence && (static_cast<unsigned char>(c) >= 0x20);
  if (is_sentence) return;
  std::fprintf(stderr, "not one sentence: %s\n", error.what());
  std::abort();
}

/// Calls `read`; refusals are fine, all else is not.
template <typename Read>
int read_or_refuse(const Read& read) {
  try {
    read();
  } catch (const std::invalid_argument& error) {
    require_sentence(error);
  } catch (const DamagedFile& error) {
    require_sentence(error);
  }
  return 0;
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace clearway::fuzz
