#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace clearway {

/// A regular file, open for reading. Anything else (a folder, pipe, socket or device, which could keep the
/// program waiting for ever) is refused without waiting for it.
class InputDescriptor {
 public:
  /// @param name what errors call the file: "recording 'x.rawlog'".
  /// @throws std::invalid_argument "<name> cannot be read: <why>."
  InputDescriptor(const std::filesystem::path& file, const std::string& name);
  ~InputDescriptor();
  InputDescriptor(const InputDescriptor&) = delete;
  InputDescriptor& operator=(const InputDescriptor&) = delete;

  int number() const { return descriptor_; }
  std::uint64_t size() const { return size_; }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// All of a text file of at most `largest` bytes. @throws std::invalid_argument as InputDescriptor does.
std::string read_text_file(const std::filesystem::path& file, const std::string& name, std::size_t largest);

}  // namespace clearway
