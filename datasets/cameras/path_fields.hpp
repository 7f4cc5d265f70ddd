#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace clearway {

/// Values of the JSON in which programs that look for cameras write them, and how errors call where they
/// stand. What fails throws std::invalid_argument "<place>: expected …".
class PathFields {
 public:
  /// Of a text that is an object. Values count as they come, so that no file asks for far more memory than
  /// its size.
  /// @param name how errors call it
  static PathFields parse(const std::string& text, const std::string& name);

  [[noreturn]] void fail(const std::string& expected) const;

  bool has(const char* key) const;
  PathFields at(const char* key) const;
  std::vector<std::string> keys() const;  ///< none of what is no object
  std::vector<PathFields> items() const;  ///< the elements of a list
  std::string text() const;
  bool is_true() const;
  double number() const;  ///< at most 1e6
  double time() const;    ///< s, of any clock
  double number_or(const char* key, double otherwise) const;
  /// All numbers of a list, or of a list of lists.
  std::vector<double> numbers() const;
  int side() const;  ///< of a picture, pixels

 private:
  PathFields(std::shared_ptr<const void> value, std::string where)
      : value_(std::move(value)), where_(std::move(where)) {}
  PathFields part(const void* value, const std::string& where) const {
    return {std::shared_ptr<const void>(value_, value), where};
  }

  std::shared_ptr<const void> value_;  ///< a nlohmann::json, in the document that it keeps
  std::string where_;
};

}  // namespace clearway
