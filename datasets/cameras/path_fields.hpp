#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace clearway {

/// Values of the JSON in which programs that look for cameras write them, and how errors call where they
/// stand. What fails throws std::invalid_argument "<place>: expected …".
class PathFields {
 public:
  using Json = nlohmann::json;

  /// @param value has to outlive it
  PathFields(const Json& value, std::string where) : value_(value), where_(std::move(where)) {}

  [[noreturn]] void fail(const std::string& expected) const;

  bool has(const char* key) const;
  PathFields at(const char* key) const;
  std::vector<std::string> keys() const;  ///< none of what is no object
  std::vector<PathFields> items() const;  ///< the elements of a list
  std::string text() const;
  bool is_true() const;
  double number() const;  ///< at most 1e6
  double number_or(const char* key, double otherwise) const;
  /// All numbers of a list, or of a list of lists.
  std::vector<double> numbers() const;
  int side() const;  ///< of a picture, pixels

 private:
  const Json& value_;
  std::string where_;
};

/// Of an object. Values count as they come, so that no file asks for far more memory than its size.
/// @throws std::invalid_argument "<name>: expected …"
nlohmann::json parse_path_json(const std::string& text, const std::string& name);

}  // namespace clearway
