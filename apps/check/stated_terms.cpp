#include "apps/check/stated_terms.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "mapping/files/number_words.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/load_json.hpp"

namespace clearway {
namespace {

constexpr Bounds any_length{-1e6, 1e6}, most_payload{0.0, 1e6}, any_gravity{-1e3, 1e3};

/// Numbers with commas between them; NaN for a word that is none.
std::vector<double> listed_numbers(std::string list) {
  std::vector<double> values;
  for (char& c : list)
    if (c == ',') c = ' ';
  std::string_view words = list;
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words))
    values.push_back(parsed_number(word).value_or(NAN));
  return values;
}

/// Loads that ride all the way: a trajectory has no legs.
std::vector<LegLoad> riding_loads(const JsonField& field) {
  std::vector<LegLoad> loads = loads_of(field);
  for (const LegLoad& load : loads)
    if (!load.legs.empty()) field.refuse("loads that ride all the way, without 'legs'");
  return loads;
}

std::optional<Eigen::Isometry3d> pose_of(const std::vector<double>& at, const std::vector<double>& turn) {
  if (at.size() != 3 || turn.size() != 4) return std::nullopt;
  const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) return std::nullopt;
  return Eigen::Translation3d(at[0], at[1], at[2]) * rotation.normalized();
}

/// The comments at the beginning of one of our exports.
class Comments {
 public:
  Comments(const std::string& text, const std::filesystem::path& file) : file_(file) {
    for (std::size_t at = 0; at < text.size() && text[at] == '#';) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      lines_.push_back(text.substr(at, end - at));
      if (lines_.back().back() == '\r') lines_.back().pop_back();
      at = end + 1;
    }
  }

  std::optional<StatedTerms> read() {
    if (lines_.empty() || lines_.front() != "# trajectory_msgs/JointTrajectory") return std::nullopt;
    bool has_base = false;
    for (const std::string& line : lines_) {
      line_ = line;
      if (begins("# base: at ")) {
        read_base();
        has_base = true;
      } else if (begins("# robot: ")) {
        read_robot();
      } else if (begins("# group: ")) {
        stated_.group = name_before("");
      } else if (begins("# held: ")) {
        const std::string joint = name_before(" at ");
        stated_.held[joint] = number();
      } else if (begins("# carries: ")) {
        read_loads();
      } else if (begins("# payload: ")) {
        stated_.payload = number();
        if (!(stated_.payload >= 0.0 && stated_.payload <= most_payload.high))
          refuse("expected a mass of 0 to 1e6 kg");
      } else if (begins("# gravity: ")) {
        read_gravity();
      } else if (begins("# map: ")) {
        name_before(", sha256 ");
        stated_.map_sha256 = name_before("");
      } else if (begins("# at ") && (rest_.find(" s: attach ") != std::string::npos ||
                                     rest_.find(" s: detach ") != std::string::npos)) {
        refuse(expected_no_events);
      }
    }
    return has_base ? std::optional(stated_) : std::nullopt;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::invalid_argument(file_.string() + ": comment " + quote(line_) + ": " + what);
  }

  /// Whether the line begins so; then `rest_` is what follows.
  bool begins(const std::string& with) {
    if (!line_.starts_with(with)) return false;
    rest_ = line_.substr(with.size());
    return true;
  }

  /// The name in quotes before this text, or at the end; `rest_` is what follows.
  std::string name_before(const std::string& text) {
    const std::size_t end = text.empty() ? rest_.size() : rest_.rfind("\"" + text);
    const std::string quoted = rest_.substr(0, text.empty() || end == std::string::npos ? end : end + 1);
    const auto name = nlohmann::json::parse(quoted, nullptr, false);
    if (end == std::string::npos || !name.is_string())
      refuse("expected a name in quotes" + (text.empty() ? "" : ", then '" + text + "…'") +
             ", as --trajectory ros writes it");
    rest_ = rest_.substr(text.empty() ? end : end + 1 + text.size());
    return name.get<std::string>();
  }

  double number() const {
    const std::optional<double> value = parsed_number(rest_);
    if (!value || !std::isfinite(*value)) refuse("expected a finite number at its end");
    return *value;
  }

  void read_robot() {
    stated_.robot = name_before(", scale ");
    stated_.scale = number();
  }

  void read_loads() {
    const auto json = nlohmann::ordered_json::parse(rest_, nullptr, false);
    if (json.is_discarded()) refuse("expected loads as JSON, as --trajectory ros writes them");
    stated_.loads = riding_loads(JsonField(json, file_.string() + ": comment '# carries'"));
  }

  void read_gravity() {
    const std::vector<double> values = listed_numbers(rest_);
    if (values.size() != 3 || !(Eigen::Vector3d(values.data()).norm() <= any_gravity.high))
      refuse("expected 'X, Y, Z' of at most 1000 m/s^2");
    stated_.gravity = Eigen::Vector3d(values.data());
  }

  void read_base() {
    const std::string between = " m, quaternion x y z w ";
    const std::size_t middle = rest_.find(between);
    std::optional<Eigen::Isometry3d> pose;
    if (middle != std::string::npos)
      pose = pose_of(listed_numbers(rest_.substr(0, middle)),
                     listed_numbers(rest_.substr(middle + between.size())));
    if (!pose || !pose->matrix().allFinite())
      refuse("expected 'at X, Y, Z m, quaternion x y z w X, Y, Z, W' of length 1");
    stated_.map_from_base = *pose;
  }

  const std::filesystem::path& file_;
  std::vector<std::string> lines_;
  std::string line_, rest_;
  StatedTerms stated_;
};

}  // namespace

const char* const expected_no_events =
    "expected none: what the robot carries, and when, is in the plan's JSON (plan --out --motion), which "
    "check reads";

std::optional<StatedTerms> stated_in_comments(const std::string& text, const std::filesystem::path& file) {
  return Comments(text, file).read();
}

std::optional<StatedTerms> stated_in_json(const YamlFields& root, const std::string& text,
                                          const std::filesystem::path& file) {
  if (!root.is_map("base")) return std::nullopt;
  StatedTerms stated;
  const YamlFields base = root.map("base");
  const auto pose =
      pose_of(base.numbers("position_m", any_length, 3), base.numbers("quaternion_xyzw", {-1.001, 1.001}, 4));
  if (!pose) base.fail("quaternion_xyzw", "expected a length of 1");
  stated.map_from_base = *pose;
  stated.robot = root.prose("robot", "");
  if (root.has("scale")) stated.scale = root.number("scale", above_zero);
  stated.group = root.prose("group", "");
  if (root.is_map("held")) {
    const YamlFields held = root.map("held");
    for (const std::string& joint : held.keys()) stated.held[joint] = held.number(joint, any_length);
  }
  if (root.has("loads")) {
    const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
    if (json.is_discarded()) root.fail("loads", "expected JSON, as --trajectory json writes it");
    stated.loads = riding_loads(JsonField(json, "trajectory " + file.string()).at("loads"));
  }
  stated.payload = root.number("payload_kg", most_payload, 0.0);
  if (root.has("gravity")) stated.gravity = Eigen::Vector3d(root.numbers("gravity", any_gravity, 3).data());
  if (root.is_map("map")) stated.map_sha256 = root.map("map").prose("sha256", "");
  return stated;
}

void state_terms(const StatedTerms& stated, Plan& plan) {
  if (!stated.robot.empty()) plan.robot = stated.robot;
  if (stated.scale) plan.robot_scale = *stated.scale;
  plan.map_from_base = stated.map_from_base;
  plan.group = stated.group;
  plan.held = stated.held;
  plan.loads = stated.loads;
  plan.payload = stated.payload;
  plan.gravity = stated.gravity.value_or(plan.gravity);
  plan.map_sha256 = stated.map_sha256;
}

}  // namespace clearway
