#include "datasets/camera_files/coefficients_beside.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>
#include <string_view>

#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Words = std::set<std::string, std::less<>>;

/// "rgb" and "distortion" of rgbDistortion, rgb_distortion and RGB-Distortion.
Words words_of_key(const std::string& key) {
  Words words;
  std::string word;
  bool was_small = false;
  const auto end_word = [&] {
    if (!word.empty()) words.insert(word);
    word.clear();
  };
  for (const char c : key) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) == 0 || (was_small && std::isupper(letter) != 0)) end_word();
    if (std::isalnum(letter) != 0) word += static_cast<char>(std::tolower(letter));
    was_small = std::islower(letter) != 0;
  }
  end_word();
  return words;
}

const Words of_coefficients{
    "distortion",   "distortions", "dist",      "coeffs",    "coeff",    "coefs", "coef",
    "coefficients", "distcoeffs",  "distcoeff", "distcoefs", "distcoef", "d",     "kc"};
const Words of_something_else{"roi", "size", "center", "model", "type", "table", "lookup"};
const Words of_any_camera{"intrinsics", "intrinsic", "camera", "cam", "cameras", "parameters",
                          "params",     "lens",      "matrix", "k",   "calib",   "calibration"};

bool have_any(const Words& words, const Words& of) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return of.contains(word); });
}

/// Which camera a key speaks of: none: of any.
Words camera_words(const std::string& key) {
  Words words = words_of_key(key);
  std::erase_if(words, [](const std::string& word) {
    return of_coefficients.contains(word) || of_any_camera.contains(word);
  });
  return words;
}

/// How many cameras are in a map, itself included; 2 stands for more.
int cameras_in(const YamlFields& fields, int depth = 0) {
  constexpr int deepest = 6;
  if (is_realsense(fields) || is_open3d(fields) || is_plain_camera(fields)) return 1;
  int count = 0;
  for (const std::string& key : fields.keys())
    if (depth < deepest && count < 2 && fields.is_map(key)) count += cameras_in(fields.map(key), depth + 1);
  return std::min(count, 2);
}

bool is_coefficients_key(const YamlFields& fields, const std::string& key) {
  const Words words = words_of_key(key);
  return (fields.is_list(key) || fields.is_map(key)) && have_any(words, of_coefficients) &&
         !have_any(words, of_something_else) && (!fields.is_map(key) || cameras_in(fields.map(key)) == 0);
}

bool is_of_other(const CameraHolder& holder, const Words& words) {
  const std::vector<std::string> keys = holder.fields.keys();
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
    return key != holder.key && !is_coefficients_key(holder.fields, key) && camera_words(key) == words;
  });
}

bool has_number(const YamlFields& fields, const std::string& key) {
  return fields.has(key) && !fields.is_map(key) && !fields.is_list(key) && !fields.is_word(key);
}

/// Whether something there is not 0, and so needs a camera whose it is.
bool bends(const CoefficientsPlace& place) {
  try {
    std::vector<double> values;
    if (!place.key.empty()) values = place.fields.flat_numbers(place.key, within_reach);
    for (const char* name : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"})
      if (place.key.empty() && has_number(place.fields, name))
        values.push_back(place.fields.number(name, within_reach));
    return std::any_of(values.begin(), values.end(), [](double value) { return value != 0.0; });
  } catch (const std::invalid_argument&) {
    return false;  // no numbers: something else of this name
  }
}

}  // namespace

bool is_realsense(const YamlFields& fields) { return fields.has("ppx"); }
bool is_open3d(const YamlFields& fields) { return fields.has("intrinsic_matrix"); }
bool is_plain_camera(const YamlFields& fields) {
  return fields.has("fx") && fields.has("fy") && fields.has("cx") && fields.has("cy");
}

std::optional<CoefficientsPlace> coefficients_at(const YamlFields& fields, const std::string& key,
                                                 const std::string& inner) {
  if (fields.is_empty(key)) return std::nullopt;
  if (!fields.is_map(key)) return CoefficientsPlace{fields, key};
  const YamlFields in = fields.map(key);
  if (in.has("data")) return CoefficientsPlace{in, "data"};
  if (in.has("k1") || in.has("p1")) return CoefficientsPlace{in, ""};
  if (!inner.empty() && (in.is_list(inner) || in.is_map(inner))) return coefficients_at(in, inner);
  for (const char* list : {"coefficients", "coeffs", "values", "params"})
    if (in.is_list(list)) return coefficients_at(in, list);
  const std::vector<std::string> keys = in.keys();
  const bool is_named_alone = std::all_of(keys.begin(), keys.end(), [](const std::string& name) {
    return have_any(words_of_key(name), of_something_else);
  });
  if (is_named_alone) return std::nullopt;
  fields.fail(key, "expected a list, or coefficients by their names, k1, k2, p1, p2, k3");
}

std::optional<CoefficientsPlace> coefficients_beside(const std::vector<CameraHolder>& holders) {
  std::optional<CoefficientsPlace> found;
  for (std::size_t i = 0; i < holders.size(); ++i) {
    const CameraHolder& holder = holders[i];
    const std::string inner = i + 1 < holders.size() ? holders[i + 1].key : "";
    const bool is_alone = cameras_in(holder.fields) == 1;
    const auto take = [&](const CoefficientsPlace& place, bool is_own, const std::string& key) {
      if (!is_own && bends(place))
        holder.fields.fail(key, "expected the coefficients inside of " + quote(holder.key) +
                                    ", or beside it as " + quote(holder.key + "_distortion"));
      if (!is_own) return;
      if (found) holder.fields.fail(key, "expected the coefficients once, got others, too");
      found = place;
    };
    if (has_number(holder.fields, "k1")) take({holder.fields, ""}, is_alone, "k1");
    for (const std::string& key : holder.fields.keys()) {
      if (key == holder.key || !is_coefficients_key(holder.fields, key)) continue;
      const Words words = camera_words(key);
      const bool is_by_camera =
          !inner.empty() && holder.fields.is_map(key) && holder.fields.map(key).has(inner);
      const bool is_own = words.empty() ? is_alone || is_by_camera : words == camera_words(holder.key);
      if (!is_own && !words.empty() && is_of_other(holder, words)) continue;
      if (const auto place = coefficients_at(holder.fields, key, inner)) take(*place, is_own, key);
    }
  }
  return found;
}

std::optional<LensModel> lens_of_holder(const YamlFields& fields) {
  const Words fisheyes{"fisheye", "opencv_fisheye", "equidistant", "kannala_brandt", "kannalabrandt8", "kb4"};
  const Words plumb_bobs{"plumb_bob", "radtan", "brown_conrady", "pinhole", "perspective", "opencv"};
  const Words others{"omni", "omnidirectional", "mei", "ucm", "eucm", "ds", "fov", "unified", "scaramuzza"};
  for (const char* key : {"distortion_model", "distortionModel", "distortion_type", "camera_model",
                          "cameraModel", "lens_model", "camera_type", "model", "lens"}) {
    if (!fields.is_word(key)) continue;
    std::string name = lower_case(fields.text(key));
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
    if (fisheyes.contains(name)) return LensModel::fisheye;
    if (plumb_bobs.contains(name)) return LensModel::plumb_bob;
    if (others.contains(name))
      fields.fail(key, "the lens " + quote(name) + " is not known, expected " + known_lenses);
  }
  return std::nullopt;
}

}  // namespace clearway
