#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// Decodes files one after the other in a DecodingChild. A file that crashes it, or takes more memory or time
/// than it may, costs that file alone: a new child goes on behind it.
class FilesInChild {
 public:
  /// What becomes of a file's bytes; called in the child. What it throws is why there is nothing.
  /// @param number of the file, from 0
  using Decode = std::function<decltype(Frame::content)(const std::string& bytes, std::size_t number)>;
  /// Begins with the first file at once: a child of a program whose other threads are at work may find a
  /// library's lock taken for good.
  /// @param what a file should be, as errors call it: "picture"
  FilesInChild(std::vector<std::filesystem::path> files, std::string what, Decode decode);

  struct Outcome {
    std::filesystem::path file;
    std::optional<decltype(Frame::content)> content;
    std::string refusal;  ///< one sentence, when there is no content
  };
  /// The next file; none after the last.
  std::optional<Outcome> next();

 private:
  void start();

  std::vector<std::filesystem::path> files_;
  std::string what_;
  Decode decode_;
  std::size_t at_ = 0;
  std::unique_ptr<DecodingChild> child_;
};

}  // namespace clearway
