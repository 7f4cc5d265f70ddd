#include "datasets/cameras/colmap_camera.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The words of each line but comments, with its number from 1.
std::vector<std::pair<std::size_t, std::vector<std::string>>> lines_of(const std::string& text) {
  std::vector<std::pair<std::size_t, std::vector<std::string>>> found;
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream stream(line.substr(0, line.find('#')));
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (!words.empty()) found.emplace_back(number, words);
  }
  return found;
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
      {"RADIAL_FISHEYE", {1, LensModel::fisheye, {0, 1}}}};
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
    refuse("expected " + std::to_string(count) + " numbers behind " + words[1] + ", got " +
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
  const auto lines = lines_of(text);
  return !lines.empty() && std::all_of(lines.begin(), lines.end(), [](const auto& line) {
    const std::vector<std::string>& words = line.second;
    return words.size() >= 2 && (words.size() >= 5 ? is_model_word(words[1]) : models().contains(words[1])) &&
           std::all_of(words[0].begin(), words[0].end(), [](char c) { return c >= '0' && c <= '9'; });
  });
}

CameraIntrinsics camera_of_colmap(const std::string& text, const std::string& name,
                                  const std::string& wanted) {
  std::vector<std::string> ids;
  const auto lines = lines_of(text);
  for (const auto& [number, words] : lines) {
    if (words[0] == wanted || (wanted.empty() && lines.size() == 1))
      return camera_of_words(words, name + ", line " + std::to_string(number));
    ids.push_back(quote(words[0]));
  }
  throw std::invalid_argument(name + " has cameras " + listed(ids) +
                              (wanted.empty() ? "" : ", none called " + quote(wanted)) +
                              ": expected `camera: {file: …, name: …}` to name one of them.");
}

}  // namespace clearway
