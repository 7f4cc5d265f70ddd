#include "planning/files/gate_line.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;
using PlainJson = nlohmann::json;

constexpr std::array<std::string_view, 3> fields = {"id", "times", "positions"};

/// Builds a chunk while nlohmann's parser reads its line. Each function returns false to stop it.
class ChunkReader {
 public:
  ChunkReader(std::string_view text, ChunkLine& line) : text_(text), line_(line) {}

  bool null() { return field_ == "id" ? id("null") : number(std::numeric_limits<double>::quiet_NaN()); }
  bool boolean(bool) { return wrong_value(); }
  bool number_integer(PlainJson::number_integer_t value) {
    return field_ == "id" ? id(std::to_string(value)) : number(static_cast<double>(value));
  }
  bool number_unsigned(PlainJson::number_unsigned_t value) {
    return field_ == "id" ? id(std::to_string(value)) : number(static_cast<double>(value));
  }
  bool number_float(PlainJson::number_float_t value, const std::string&) {
    return field_ == "id" ? wrong_value() : number(value);
  }
  bool string(std::string& value) {
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
      return refuse("the chunk has a field " + quote(name) + ", expected id, times and positions");
    bool& is_given = given_[static_cast<std::size_t>(known - fields.begin())];
    if (is_given) return refuse("the chunk has the field '" + name + "' twice");
    is_given = true;
    field_ = *known;
    return true;
  }
  bool end_object() {
    for (const std::size_t i : {1U, 2U}) {
      if (!given_[i]) return refuse("the chunk has no field '" + std::string(fields[i]) + "'");
    }
    field_ = {};
    --depth_;
    return true;
  }

  bool start_array(std::size_t) {
    const bool fits = (field_ == "times" && depth_ == 1) || (field_ == "positions" && depth_ <= 2);
    if (!fits || depth_ == 0) return wrong_value();
    ++depth_;
    values_.clear();
    return true;
  }
  bool end_array() {
    --depth_;
    if (field_ == "times") line_.chunk.times = values_;
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
    const int wanted = field_ == "times" ? 2 : field_ == "positions" ? 3 : -1;
    if (depth_ != wanted) return wrong_value();
    values_.push_back(value);
    return true;
  }

  /// "positions[2][1]": of the value that comes next.
  std::string place() const {
    std::string name(field_);
    if (field_ == "positions" && depth_ >= 2)
      name += "[" + std::to_string(line_.chunk.positions.size()) + "]";
    if (depth_ == (field_ == "times" ? 2 : 3)) name += "[" + std::to_string(values_.size()) + "]";
    return name.empty() ? "the line" : name;
  }
  bool wrong_value() {
    const std::string wanted = field_ == "id"                         ? "a text or a whole number"
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
    const bool is_value_wanted = depth_ == (field_ == "times" ? 2 : field_ == "positions" ? 3 : -1);
    return is_value_wanted && (word == "nan" || word == "inf" || word == "infinity");
  }

  bool refuse(std::string sentence) { return refuse(GateReason::not_a_chunk, std::move(sentence)); }
  bool refuse(GateReason reason, std::string sentence) {
    line_.fault = {reason, std::move(sentence)};
    return false;
  }

  std::string_view text_;
  ChunkLine& line_;
  std::string_view field_;  ///< whose value is read
  std::array<bool, 3> given_{};
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
