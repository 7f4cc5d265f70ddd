#pragma once

#include <string>

namespace clearway {

/// Whether a text is XML: its first character that is not blank is '<'.
bool is_xml(const std::string& text);

/// What OpenCV's FileStorage wrote as XML, as YAML of the same keys on the same lines: elements are keys, `_`
/// are items of lists, texts of several words are lists of them. OpenCV's own reader is not asked: it prints
/// what it finds wrong, and may crash on a hostile file.
/// @param name what errors call the file
/// @throws std::invalid_argument in one sentence: not XML, not an `opencv_storage`, or more than 32 elements
/// inside each other
std::string yaml_of_opencv_xml(const std::string& text, const std::string& name);

}  // namespace clearway
