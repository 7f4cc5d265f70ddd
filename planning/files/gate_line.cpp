#include "planning/files/gate_line.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"
#include "planning/robot/joint_names.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;
using PlainJson = nlohmann::json;

constexpr std::array<std::string_view, 6> fields = {"id",     "times",     "positions",
                                                    "joints", "leaves_at", "restart"};
constexpr std::size_t times_field = 1, positions_field = 2, leaves_at_field = 4, restart_field = 5;

/// Builds a chunk while nlohmann's parser reads its line. Each function returns false to stop it.
class ChunkReader {
 public:
  ChunkReader(std::string_view text, ChunkLine& line) : text_(text), line_(line) {}

  bool null() {
    if (field_ == "id") return id("null");
    return (field_ == "restart" && depth_ == 1) || number(std::numeric_limits<double>::quiet_NaN());
  }
  bool boolean(bool) { return wrong_value(); }
  bool number_integer(PlainJson::number_integer_t value) {
    return field_ == "id" ? id(std::to_string(value)) : number(static_cast<double>(value));
  }
  bool number_unsigned(PlainJson::number_unsigned_t value) {
    if (field_ == "leaves_at" && depth_ == 1) {
      line_.leaves_at = value;
      return true;
    }
    return field_ == "id" ? id(std::to_string(value)) : number(static_cast<double>(value));
  }
  bool number_float(PlainJson::number_float_t value, const std::string&) {
    return field_ == "id" ? wrong_value() : number(value);
  }
  bool string(std::string& value) {
    if (field_ == "joints" && depth_ == 2) {
      line_.joints->push_back(std::move(value));
      return true;
    }
    return field_ == "id" ? id(PlainJson(value).dump(-1, ' ', true)) : wrong_value();
  }
  bool binary(PlainJson::binary_t&) { return wrong_value(); }

  bool start_object(std::size_t) {
    if (depth_ != 0) return wrong_value();
    ++depth_;
    return true;
  }
  bool key(std::string& name) {
    const auto known = std::find(fields.begin(), fields.end(), name);
    if (known == fields.end())
      return refuse("the chunk has a field " + quote(name) +
                    ", expected id, times, positions, joints, leaves_at or restart");
    bool& is_given = given_[static_cast<std::size_t>(known - fields.begin())];
    if (is_given) return refuse("the chunk has the field '" + name + "' twice");
    is_given = true;
    line_.restarts = given_[restart_field];
    field_ = *known;
    return true;
  }
  bool end_object() {
    for (const std::size_t i : {times_field, positions_field, leaves_at_field}) {
      const std::string name = "'" + std::string(fields[i]) + "'";
      if (line_.restarts && given_[i])
        return refuse("the line restarts, expected no field " + name + " in it");
      if (!line_.restarts && !given_[i] && i != leaves_at_field)
        return refuse("the chunk has no field " + name);
    }
    field_ = {};
    --depth_;
    return true;
  }

  bool start_array(std::size_t) {
    const bool is_list = field_ == "times" || field_ == "joints" || field_ == "restart";
    const bool fits = (is_list && depth_ == 1) || (field_ == "positions" && depth_ <= 2);
    if (!fits || depth_ == 0) return wrong_value();
    ++depth_;
    values_.clear();
    if (field_ == "joints") line_.joints.emplace();
    return true;
  }
  bool end_array() {
    --depth_;
    if (field_ == "times") line_.chunk.times = values_;
    if (field_ == "restart")
      line_.restart =
          Eigen::Map<const Eigen::VectorXd>(values_.data(), static_cast<Eigen::Index>(values_.size()));
    if (field_ == "positions" && depth_ == 2)
      line_.chunk.positions.emplace_back(
          Eigen::Map<const Eigen::VectorXd>(values_.data(), static_cast<Eigen::Index>(values_.size())));
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const PlainJson::exception& error) {
    constexpr int number_too_large = 406;
    if (error.id == number_too_large || is_word_for_no_number(position))
      return refuse(GateReason::not_finite, place() + " is not finite, expected a number");
    try {
      require_json(text_, "the line");
    } catch (const std::invalid_argument& words) {
      return refuse(words.what());
    }
    return refuse("the line is not valid JSON");
  }

 private:
  bool id(std::string json) {
    if (depth_ != 1) return wrong_value();
    line_.id = std::move(json);
    return true;
  }
  bool number(double value) {
    if (depth_ != depth_of_numbers()) return wrong_value();
    values_.push_back(value);
    return true;
  }

  int depth_of_numbers() const {
    return field_ == "times" || field_ == "restart" ? 2 : field_ == "positions" ? 3 : -1;
  }

  /// "positions[2][1]": of the value that comes next.
  std::string place() const {
    std::string name(field_);
    if (field_ == "positions" && depth_ >= 2)
      name += "[" + std::to_string(line_.chunk.positions.size()) + "]";
    if (depth_ == depth_of_numbers()) name += "[" + std::to_string(values_.size()) + "]";
    if (field_ == "joints" && depth_ == 2) name += "[" + std::to_string(line_.joints->size()) + "]";
    return name.empty() ? "the line" : name;
  }
  bool wrong_value() {
    const std::string wanted = field_ == "id"                         ? "a text or a whole number"
                               : field_ == "leaves_at"                ? "a whole number from 0"
                               : field_ == "restart" && depth_ == 1   ? "a list of numbers, or null"
                               : field_ == "joints" && depth_ == 1    ? "a list of names"
                               : field_ == "joints"                   ? "a name"
                               : field_ == "times" && depth_ == 1     ? "a list of numbers"
                               : field_ == "positions" && depth_ == 1 ? "a list of configurations"
                               : field_ == "positions" && depth_ == 2 ? "a list of numbers"
                               : depth_ == 0                          ? "an object"
                                                                      : "a number";
    return refuse(place() + ": expected " + wanted);
  }

  /// NaN and Infinity, as Python and JavaScript write them into what should be JSON.
  bool is_word_for_no_number(std::size_t position) const {
    const auto is_letter = [&](std::size_t at) {
      const char c = at < text_.size() ? text_[at] : ' ';
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    };
    std::size_t begin = std::min(position > 0 ? position - 1 : 0, text_.size());
    while (begin > 0 && is_letter(begin - 1)) --begin;
    std::size_t end = begin;
    while (is_letter(end)) ++end;
    std::string word(text_.substr(begin, end - begin));
    for (char& c : word) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return depth_ == depth_of_numbers() && (word == "nan" || word == "inf" || word == "infinity");
  }

  bool refuse(std::string sentence) { return refuse(GateReason::not_a_chunk, std::move(sentence)); }
  bool refuse(GateReason reason, std::string sentence) {
    line_.fault = {reason, std::move(sentence)};
    return false;
  }

  std::string_view text_;
  ChunkLine& line_;
  std::string_view field_;  ///< whose value is read
  std::array<bool, fields.size()> given_{};
  int depth_ = 0;
  std::vector<double> values_;
};

Json point_json(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

Json piece_json(const MotionPiece& piece) {
  const auto at = static_cast<std::int64_t>(piece.waypoint);
  switch (piece.kind) {
    case MotionPiece::Kind::joining:
      return {{"kind", "joining"}, {"to", 0}};
    case MotionPiece::Kind::edge:
      return {{"kind", "edge"}, {"from", at}, {"to", at + 1}};
    case MotionPiece::Kind::braking:
      return {{"kind", "braking"}, {"from", at}};
  }
  return {};
}

/// Whether what blocks is in the map, rather than in the robot.
bool is_in_map(Obstruction obstruction) {
  switch (obstruction) {
    case Obstruction::none:
    case Obstruction::not_finite:
    case Obstruction::joint_limit:
    case Obstruction::self_collision:
      return false;
    default:
      return true;
  }
}

Json history_json(const VoxelEvidence& evidence) {
  Json json{{"hits", evidence.hit_count}, {"passes", evidence.pass_count}};
  if (evidence.forgotten > 0) json["scans_not_kept"] = evidence.forgotten;
  json["hit_by_scans"] = Json::array();
  for (const ScanName& scan : evidence.hits)
    json["hit_by_scans"].push_back({{"scan", scan.number}, {"sensor", scan.sensor}, {"time", scan.time}});
  json["strokes"] = Json::array();
  for (const StrokeName& stroke : evidence.strokes)
    json["strokes"].push_back({{"volume", stroke.volume},
                               {"stroke", stroke.stroke},
                               {"source", stroke.source},
                               {"erases", stroke.erases},
                               {"from_s", stroke.first},
                               {"to_s", stroke.last}});
  return json;
}

Json voxel_json(const GateVerdict& verdict) {
  const VoxelEvidence& evidence = *verdict.evidence;
  Json json{{"center", point_json(verdict.obstruction.point)}};
  json["state"] = to_string(evidence.voxel.state);
  if (const Obstruction blocks = verdict.obstruction.obstruction; is_in_map(blocks))
    json["blocks_as"] = to_string(blocks);
  if (evidence.voxel.observed) json["log_odds"] = evidence.voxel.log_odds;
  if (evidence.last_seen) json["last_seen_s"] = *evidence.last_seen;
  json["painted_by"] = evidence.painted_by;
  if (evidence.has_history) json["history"] = history_json(evidence);
  return json;
}

Json part_json(const ProvedPart& part) {
  return {{"until_s", part.time}, {"position", json_of(part.position)}, {"stands_at", json_of(part.stop)}};
}

}  // namespace

ChunkLine parse_chunk_line(std::string_view text) {
  ChunkLine line;
  ChunkReader reader(text, line);
  const bool is_whole = PlainJson::sax_parse(text, &reader);
  if (!is_whole && line.is_read()) line.fault = {GateReason::not_a_chunk, "the line is not a chunk"};
  return line;
}

void take_order_of(const Robot& robot, ChunkLine& line) {
  if (!line.joints || !line.is_read()) return;
  const std::vector<std::string> own = joint_names(robot);
  std::vector<std::string> given = *line.joints, wanted = own;
  std::sort(given.begin(), given.end());
  std::sort(wanted.begin(), wanted.end());
  if (given != wanted) {
    line.fault = {GateReason::not_a_chunk, "joints: expected each of " + listed(own) + " once, got " +
                                               (given.empty() ? "none" : listed(*line.joints))};
    return;
  }
  const auto reorder = [&](Configuration& q) {
    if (q.size() != static_cast<Eigen::Index>(own.size())) return;  // told when it is judged
    const Configuration sent = q;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const auto place = std::find(own.begin(), own.end(), (*line.joints)[i]) - own.begin();
      q[place] = sent[static_cast<Eigen::Index>(i)];
    }
  };
  for (Configuration& q : line.chunk.positions) reorder(q);
  if (line.restart) reorder(*line.restart);
}

std::string restart_line(std::size_t number, const std::string& id, const std::string& sentence) {
  Json json{{"line", number}, {"id", Json::parse(id)}, {"restarted", sentence.empty()}};
  if (!sentence.empty()) json["sentence"] = sentence;
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string verdict_line(std::size_t number, const std::string& id, const GateVerdict& verdict) {
  Json json{{"line", number},
            {"id", Json::parse(id)},
            {"passed", verdict.is_passed()},
            {"reason", to_string(verdict.reason)}};
  if (!verdict.is_passed()) json["sentence"] = verdict.sentence;
  if (verdict.piece) {
    json["piece"] = piece_json(*verdict.piece);
    json["piece"]["proved_share"] = verdict.parameter;
    if (!verdict.obstruction.part.empty()) json["body"] = verdict.obstruction.part;
    if (!verdict.obstruction.other.empty()) json["other"] = verdict.obstruction.other;
  }
  if (verdict.evidence) json["voxel"] = voxel_json(verdict);
  json["may_go"] = verdict.may_go ? part_json(*verdict.may_go) : Json();
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace clearway
