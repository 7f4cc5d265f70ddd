#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "datasets/ros/message_bag.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {

/// The files of a bag, which stay open: one, or those of a folder.
class BagFiles {
 public:
  /// @throws std::invalid_argument when there is none to read, or a folder holds two kinds
  explicit BagFiles(const std::filesystem::path& bag);

  std::uint64_t size() const { return size_; }  ///< bytes, of all
  /// Of the first file.
  int descriptor() const { return inputs_.front()->descriptor(); }
  /// A clause that names those of the parts that are not read; "": all are.
  std::string missing(const std::vector<std::string>& parts) const;
  /// In the child: its messages, those of several files one after the other in the order of their first ones.
  /// @param descriptor of the first file @throws std::runtime_error a clause, when it cannot be read
  std::unique_ptr<MessageBag> open(int descriptor) const;

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<InputFile>> inputs_;
  std::uint64_t size_ = 0;
};

/// What is wrong with a bag, as one sentence without its end.
std::string bag_sentence(const std::filesystem::path& file, const std::string& clause);

}  // namespace clearway
