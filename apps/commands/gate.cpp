#include <istream>
#include <memory>
#include <optional>
#include <ostream>

#include "apps/console/commands.hpp"
#include "apps/console/line_reader.hpp"
#include "apps/console/parse.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "apps/query/survey_figures.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/maps/hand_edit.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check.hpp"
#include "planning/files/gate_line.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {

namespace {

GateOptions gate_options(const GateCommandOptions& options, const Robot& robot) {
  GateOptions gate;
  if (!options.max_velocity.empty()) gate.limits.max_velocity = options.max_velocity;
  if (!options.deceleration.empty()) gate.limits.deceleration = options.deceleration;
  gate.limits.reaction = options.reaction;
  gate.tolerance = options.tolerance;
  if (options.max_age) gate.max_age = *options.max_age;
  if (options.max_duration) gate.limits.max_duration = *options.max_duration;
  require_parts(options.allow_outside, robot, "--allow-outside");
  gate.allow_outside = options.allow_outside;
  if (!options.start.empty()) gate.start = choose_configuration(options.start, "--start", robot, false);
  return gate;
}

/// Time of the map's newest observation; 0 without --max-age.
double newest_look(const GateCommandOptions& options, const Snapshot& map) {
  const SeenStamps* const seen = map.seen();
  if (!options.max_age) return 0.0;
  if (seen == nullptr || seen->empty())
    throw std::invalid_argument(
        "--max-age: the map does not know when it was last seen, expected one made of "
        "scans with times");
  return seen->newest();
}

/// With what it holds; a gate knows no legs.
Robot loaded_robot(const GateCommandOptions& options) {
  const Robot robot = choose_robot(options.robot);
  const std::vector<LegLoad> loads = choose_loads(options.attach, robot);
  for (const LegLoad& load : loads)
    if (!load.legs.empty())
      throw std::invalid_argument("--attach: load " + quote(load.load.name) +
                                  " rides on single legs, of which a gate knows none; expected no 'legs'");
  return with_all_loads(robot, loads);
}

/// What its verdicts rest on, which no single one of them says.
void print_terms(const ConfigurationSpace& space, Console& console) {
  const Robot& robot = space.robot();
  console.log("policy: " + describe_policies(space.policies(), space.options().seen_within) +
              "; padding: " + describe_padding(space.options().padding, robot.position_accuracy));
  if (const std::string note = only_seen_sentence(robot.only_seen); !note.empty())
    console.warn("warning: " + note);
  console.log("joints: " + listed(joint_names(robot)));
  for (const Load& load : robot.loads) console.log("load: " + load.name + " on " + load.link);
  const PathSurvey survey = survey_path(robot, space.map(), space.policies(), {});
  console.note({unknown_sentence(survey), integration_caveat(space.map())});
}

/// No chunk that begins there can pass.
void report_start(const ConfigurationSpace& space, const GateOptions& terms, Console& console) {
  if (!terms.start || space.is_free(*terms.start)) return;
  console.warn("warning: --start is not free, so no chunk passes: " + space.check(*terms.start).sentence());
}

/// What a line is answered. A line that restarts counts only where it is refused.
struct LineAnswer {
  std::string text;
  bool counts, is_passed;
};

GateVerdict too_long(std::size_t most) {
  return {.reason = GateReason::line_too_long,
          .sentence = "the line is longer than " + std::to_string(most) + " bytes"};
}

/// What robot and map leave in doubt.
void report_inputs(const GateCommandOptions& options, const Robot& robot, const Snapshot& map,
                   Console& console) {
  console.note(robot_notes(robot, robot_request(options.robot).packages));
  console.note(painted_csv_remark(options.map, map));
  console.note(cloud_remark(options.map, map, options.cloud_resolution.has_value()));
  if (const std::string caveat = damage_caveat(map); !caveat.empty()) console.warn("warning: " + caveat);
  console.note(contradiction_caveat(map));
  console.note(hand_edit_caveat(map));
}

/// Answers line by line. After a line that should say where the robot stands, and cannot, nobody knows:
/// chunks are refused until one does.
class LineGate {
 public:
  LineGate(Gate& gate, const Robot& robot, std::size_t max_line)
      : gate_(gate), robot_(robot), max_line_(max_line) {}

  LineAnswer answer(const InputLine& text) {
    ++number_;
    if (text.is_too_long) return said("null", too_long(max_line_));
    ChunkLine line = parse_chunk_line(text.text);
    take_order_of(robot_, line);
    if (line.restarts) {
      const std::string why_not = line.is_read() ? restart(line) : line.fault.sentence;
      refused_restart_ = why_not.empty() ? 0 : number_;
      return {restart_line(number_, line.id, why_not), !why_not.empty(), false};
    }
    if (!line.is_read()) return said(line.id, {.reason = line.fault.reason, .sentence = line.fault.sentence});
    if (refused_restart_ > 0)
      return said(line.id, {.reason = GateReason::jump,
                            .sentence = "nobody knows where the robot stands since the restart of line " +
                                        std::to_string(refused_restart_) + " was refused: expected another"});
    return said(line.id, gate_.judge(line.chunk, line.leaves_at));
  }

 private:
  LineAnswer said(const std::string& id, const GateVerdict& verdict) const {
    return {verdict_line(number_, id, verdict), true, verdict.is_passed()};
  }

  /// Empty, or why not.
  std::string restart(const ChunkLine& line) {
    try {
      gate_.restart(line.restart);
      return {};
    } catch (const std::invalid_argument& error) {
      const std::string sentence = error.what(), begin = "gate: start";
      return sentence.starts_with(begin) ? "restart" + sentence.substr(begin.size()) : sentence;
    }
  }

  Gate& gate_;
  const Robot& robot_;
  std::size_t max_line_, number_ = 0;
  std::size_t refused_restart_ = 0;  ///< its line; 0: none since the last one that was taken
};

/// An answer for each line, until there are no more, or nobody reads them.
int answer_lines(Gate& gate, const Robot& robot, std::size_t max_line, Console& console) {
  LineReader lines(console.in(), max_line);
  LineGate answers(gate, robot, max_line);
  std::size_t chunks = 0, passed = 0;
  while (const std::optional<InputLine> text = lines.next()) {
    const LineAnswer answered = answers.answer(*text);
    chunks += answered.counts;
    passed += answered.is_passed;
    console.out() << answered.text << '\n';
    if (!console.out().flush()) return exit_bad_input;  // nobody reads them any more; main reports it
  }
  console.log(grouped(chunks) + " chunks: " + grouped(passed) + " passed, " + grouped(chunks - passed) +
              " refused");
  return passed == chunks ? exit_done : exit_no;
}

}  // namespace

int run_gate(const GateCommandOptions& options, Console& console) {
  const Robot robot = loaded_robot(options);
  if (const std::string disagreement = file_disagreement(robot); !disagreement.empty())
    throw std::invalid_argument(disagreement);
  const Policies policies = choose_policies(options.robot.policies, robot);
  const GateOptions gate_terms = gate_options(options, robot);
  joint_limits(robot, gate_terms.limits);  // throws before the map is read
  Gate gate(gate_terms);
  const LoadedMap loaded = load_map_with(options.map, {}, options.cloud_resolution);
  const Snapshot& map = loaded.map;
  report_inputs(options, robot, map, console);
  std::shared_ptr<const Provenance> history;
  if (auto found = load_provenance(options.map); found && found->map_sha256 == loaded.sha256)
    history = std::make_shared<const Provenance>(std::move(*found));
  const double padding = choose_padding(options.robot, robot);
  const double seen_within = options.robot.seen_within.value_or(0.0);
  ConfigurationSpace space = padded_space(robot, map, policies, padding, seen_within);
  print_terms(space, console);
  report_start(space, gate_terms, console);
  gate.publish(std::move(space), newest_look(options, map), history);
  return answer_lines(gate, robot, options.max_line, console);
}

}  // namespace clearway
