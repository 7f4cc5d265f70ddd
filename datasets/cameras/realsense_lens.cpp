#include "datasets/cameras/realsense_lens.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// rs2_distortion, in its order.
constexpr std::array<const char*, 6> realsense_models = {
    "none", "modifiedbrownconrady", "inversebrownconrady", "ftheta", "brownconrady", "kannalabrandt4"};

/// Small letters and digits alone, without what the languages put before them.
std::string bare_model(const std::string& model) {
  std::string bare;
  for (const char c : model)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      bare += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string before : {"rs2", "distortion"})
    if (bare.starts_with(before)) bare.erase(0, before.size());
  if (bare.size() == 1 && bare[0] >= '0' && bare[0] <= '5')
    return realsense_models[static_cast<std::size_t>(bare[0] - '0')];
  return bare;
}

}  // namespace

bool is_realsense_lens(const std::string& model) {
  const std::string bare = bare_model(model);
  return bare != "none" && model.size() > 1 &&
         std::find(realsense_models.begin(), realsense_models.end(), bare) != realsense_models.end();
}

void set_realsense_lens(CameraIntrinsics& camera, const std::string& model,
                        std::span<const double> coefficients) {
  const std::string bare = bare_model(model);
  const bool is_straight =
      std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c == 0.0; });
  if (bare == "brownconrady") return set_lens(camera, LensModel::plumb_bob, coefficients);
  if (bare == "kannalabrandt4") return set_lens(camera, LensModel::fisheye, coefficients);
  const bool is_known =
      bare.empty() || bare == "none" || bare == realsense_models[1] || bare == realsense_models[2];
  if (is_known && is_straight) return set_lens(camera, LensModel::plumb_bob, {});
  throw std::runtime_error(
      "the lens " + (model.empty() ? "is not named" : quote(model) + " is none of OpenCV's") +
      ": expected Brown Conrady or Kannala Brandt4" + (is_known ? ", or coefficients that are all 0" : ""));
}

}  // namespace clearway
