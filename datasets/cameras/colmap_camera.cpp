#include "datasets/cameras/colmap_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/byte_reader.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The words of one camera, and where errors say that they stand.
struct Entry {
  std::string place;
  std::vector<std::string> words;
};

/// The words of each line but comments.
std::vector<Entry> lines_of(const std::string& text) {
  std::vector<Entry> found;
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream stream(line.substr(0, line.find('#')));
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (!words.empty()) found.push_back({"line " + std::to_string(number), words});
  }
  return found;
}

/// By their numbers in cameras.bin, with how many parameters they have (COLMAP, src/colmap/sensor/models.h).
struct NumberedModel {
  const char* name;
  std::size_t parameters;
};
constexpr std::array<NumberedModel, 18> numbered_models{{{"SIMPLE_PINHOLE", 3},
                                                         {"PINHOLE", 4},
                                                         {"SIMPLE_RADIAL", 4},
                                                         {"RADIAL", 5},
                                                         {"OPENCV", 8},
                                                         {"OPENCV_FISHEYE", 8},
                                                         {"FULL_OPENCV", 12},
                                                         {"FOV", 5},
                                                         {"SIMPLE_RADIAL_FISHEYE", 4},
                                                         {"RADIAL_FISHEYE", 5},
                                                         {"THIN_PRISM_FISHEYE", 12},
                                                         {"RAD_TAN_THIN_PRISM_FISHEYE", 16},
                                                         {"SIMPLE_DIVISION", 4},
                                                         {"DIVISION", 5},
                                                         {"SIMPLE_FISHEYE", 3},
                                                         {"FISHEYE", 4},
                                                         {"EUCM", 6},
                                                         {"EQUIRECTANGULAR", 2}}};

/// The same of cameras.bin: a count, then id, model, width, height and parameters of each. Nothing where the
/// bytes are no such file from the first to the last.
std::optional<std::vector<Entry>> entries_of(const std::string& bytes) {
  const std::filesystem::path nowhere;
  ByteReader reader(bytes, nowhere);
  try {
    constexpr std::size_t smallest = 4 + 4 + 8 + 8 + 2 * 8;
    std::vector<Entry> found(reader.count(smallest));
    for (Entry& entry : found) {
      const std::string id = std::to_string(reader.get<std::uint32_t>());
      const auto model = reader.get<std::uint32_t>();
      if (model >= numbered_models.size()) return std::nullopt;
      entry = {"camera " + id, {id, numbered_models[model].name}};
      for (int side = 0; side < 2; ++side) entry.words.push_back(std::to_string(reader.get<std::uint64_t>()));
      for (std::size_t i = 0; i < numbered_models[model].parameters; ++i)
        entry.words.push_back(to_text(reader.get<double>()));
    }
    if (found.empty() || !reader.at_end()) return std::nullopt;
    return found;
  } catch (const DamagedFile&) {
    return std::nullopt;
  }
}

/// How a model's parameters follow each other.
struct Model {
  std::size_t focal_lengths;  ///< one for both axes, or two
  LensModel lens;
  std::vector<std::size_t> places;  ///< of its coefficients among the lens's
};

const std::map<std::string, Model>& models() {
  static const std::map<std::string, Model> all{
      {"SIMPLE_PINHOLE", {1, LensModel::plumb_bob, {}}},
      {"PINHOLE", {2, LensModel::plumb_bob, {}}},
      {"SIMPLE_RADIAL", {1, LensModel::plumb_bob, {0}}},
      {"RADIAL", {1, LensModel::plumb_bob, {0, 1}}},
      {"OPENCV", {2, LensModel::plumb_bob, {0, 1, 2, 3}}},
      {"FULL_OPENCV", {2, LensModel::rational, {0, 1, 2, 3, 4, 5, 6, 7}}},
      {"OPENCV_FISHEYE", {2, LensModel::fisheye, {0, 1, 2, 3}}},
      {"SIMPLE_RADIAL_FISHEYE", {1, LensModel::fisheye, {0}}},
      {"RADIAL_FISHEYE", {1, LensModel::fisheye, {0, 1}}},
      {"SIMPLE_FISHEYE", {1, LensModel::fisheye, {}}},
      {"FISHEYE", {2, LensModel::fisheye, {}}}};
  return all;
}

bool is_model_word(const std::string& word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  }) && word[0] >= 'A';
}

CameraIntrinsics camera_of_words(const std::vector<std::string>& words, const std::string& where) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument(where + ": " + what + ".");
  };
  const auto model = models().find(words[1]);
  if (model == models().end()) {
    std::vector<std::string> names;
    for (const auto& [name, ignored] : models()) names.push_back(name);
    refuse("the camera model " + quote(words[1]) + " is not known here, expected one of " + listed(names));
  }
  std::vector<double> numbers;
  for (std::size_t i = 2; i < words.size(); ++i) {
    const auto number = finite_number(words[i]);
    if (!number || std::abs(*number) > 1e6)
      refuse("expected a number from -1e6 to 1e6, got " + quote(shortened(words[i])));
    numbers.push_back(*number);
  }
  const auto& [focal_lengths, lens, places] = model->second;
  const std::size_t count = 2 + focal_lengths + 2 + places.size();
  if (numbers.size() != count)
    refuse("expected " + counted(count, "number") + " behind " + words[1] + ", got " +
           std::to_string(numbers.size()));
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
    if (!(numbers[i] >= 32 && numbers[i] <= 20000 && numbers[i] == std::round(numbers[i])))
      refuse("expected a width and a height of 32 to 20000 pixels");
  const double* focal = &numbers[2];
  const double* centre = focal + focal_lengths;
  if (!(focal[0] >= 1e-9 && focal[focal_lengths - 1] >= 1e-9)) refuse("expected focal lengths above 0");
  CameraIntrinsics camera{static_cast<int>(numbers[0]),
                          static_cast<int>(numbers[1]),
                          focal[0],
                          focal[focal_lengths - 1],
                          centre[0] - 0.5,
                          centre[1] - 0.5,
                          {}};
  std::vector<double> coefficients(coefficient_count(lens), 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) coefficients[places[i]] = centre[2 + i];
  set_lens(camera, lens, coefficients);
  return camera;
}

}  // namespace

bool is_colmap_cameras(const std::string& text) {
  if (entries_of(text)) return true;
  const auto lines = lines_of(text);
  return !lines.empty() && std::all_of(lines.begin(), lines.end(), [](const Entry& line) {
    const std::vector<std::string>& words = line.words;
    return words.size() >= 2 && (words.size() >= 5 ? is_model_word(words[1]) : models().contains(words[1])) &&
           std::all_of(words[0].begin(), words[0].end(), [](char c) { return c >= '0' && c <= '9'; });
  });
}

CameraIntrinsics camera_of_colmap(const std::string& text, const std::string& name,
                                  const std::string& wanted) {
  std::vector<std::string> ids;
  const auto binary = entries_of(text);
  const std::vector<Entry> entries = binary ? *binary : lines_of(text);
  for (const auto& [place, words] : entries) {
    if (words[0] == wanted || (wanted.empty() && entries.size() == 1))
      return camera_of_words(words, name + ", " + place);
    ids.push_back(quote(words[0]));
  }
  throw std::invalid_argument(name + " has cameras " + listed(ids) +
                              (wanted.empty() ? "" : ", none called " + quote(wanted)) +
                              ": expected `camera: {file: …, name: …}` to name one of them.");
}

}  // namespace clearway
