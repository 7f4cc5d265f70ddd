#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace clearway {

/// What is damaged of the files of a folder: the sentence of the first one, and how many more there are.
class FolderDamage {
 public:
  void note(const std::string& damage) {
    if (count_++ == 0) first_ = damage;
  }
  /// @param files of the folder. @param kind what they are called, as "pictures"
  std::optional<std::string> sentence(std::size_t files, std::string_view kind) const {
    if (count_ == 0) return std::nullopt;
    if (count_ == 1) return first_;
    return first_ + "; " + std::to_string(count_ - 1) + " more of " + std::to_string(files) + " " +
           std::string(kind) + (count_ == 2 ? " is" : " are") + " damaged, too";
  }

 private:
  std::size_t count_ = 0;
  std::string first_;
};

}  // namespace clearway
