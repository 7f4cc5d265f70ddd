#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

#include "mapping/system/damaged_file.hpp"

namespace clearway {

/// Appends a number as it lies in memory: little-endian on the machines that Clearway runs on.
template <class Number>
void put(std::string& bytes, Number value) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), &value, sizeof(Number));
  bytes.append(raw.data(), raw.size());
}

/// Takes numbers off the bytes of a file; each read is held against what is left.
class ByteReader {
 public:
  /// @param file only named in messages; must live as long as the reader
  ByteReader(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  /// @throws DamagedFile
  [[noreturn]] void refuse(const std::string& reason) const {
    throw DamagedFile("'" + file_.string() + "' is damaged: " + reason);
  }

  /// The next `size` bytes. @throws DamagedFile when there are not as many.
  std::string_view take(std::size_t size) {
    if (bytes_.size() < size) refuse("it is cut off");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  /// The next number. @throws DamagedFile when it is cut off or not finite.
  template <class Number>
  Number get() {
    Number value;
    std::memcpy(&value, take(sizeof(Number)).data(), sizeof(Number));
    if constexpr (std::is_floating_point_v<Number>) {
      if (!std::isfinite(value)) refuse("it holds a number that is not finite");
    }
    return value;
  }

  /// A number of entries of at least `smallest` bytes each. @throws DamagedFile when they cannot follow.
  std::size_t count(std::size_t smallest) {
    const auto value = get<std::uint64_t>();
    if (value > bytes_.size() / smallest) refuse("it is cut off");
    return value;
  }

  bool at_end() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
  const std::filesystem::path& file_;
};

}  // namespace clearway
