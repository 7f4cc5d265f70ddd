#pragma once

#include <set>
#include <string>

namespace clearway {

/// Words for names of foreign files: letters, digits and ._-= of a name, at most 60; others become _. Each
/// once: a second one of the same letters gets a number.
class FileWords {
 public:
  FileWords() = default;
  explicit FileWords(std::set<std::string> taken) : taken_(std::move(taken)) {}

  std::string of(const std::string& name);

 private:
  std::set<std::string> taken_;
};

}  // namespace clearway
