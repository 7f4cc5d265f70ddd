#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/fusion/fusion.hpp"
#include "apps/teach/marked_object.hpp"
#include "apps/teach/taught_loads.hpp"
#include "apps/teach/teach_event.hpp"
#include "apps/teach/virtual_robot.hpp"
#include "planning/files/plan_file.hpp"

namespace clearway {

/// What a session does; each refuses what does not belong, see TeachSession.
enum class TeachState {
  ready,      ///< nothing is chosen
  painting,   ///< the ball paints
  erasing,    ///< the ball erases
  marking,    ///< the ball marks an object
  selecting,  ///< a start is chosen
  planning,   ///< a planner works on a map of its own; frames go on
  planned,    ///< a plan is proved, and nothing that it rests on was changed by hand since
  playing,    ///< the virtual robot moves along it
  approved,   ///< a person has approved it
  ended
};
std::string_view to_string(TeachState state);

/// An event and what became of it.
struct TaughtEvent {
  TeachEvent event;
  TeachState state = TeachState::ready;  ///< afterwards
  std::string refusal;                   ///< why not, with its cure; empty: it was done
  std::string remark;                    ///< what was done, where that is worth a sentence
  /// Refused only because a planner still worked, or a plan that was stopped: a replay leaves it out.
  bool is_late = false;
};

/// A plan of a session and the map that it rests on.
struct TaughtPlan {
  std::string name;
  Plan plan;
  Configuration start;
  std::vector<Configuration> goals;  ///< as they were chosen
  std::shared_ptr<const ConfigurationSpace> space;
  RobotChoice robot;
  std::string map_digest;
  bool is_approved = false;
  std::string void_reason{};              ///< why an approved plan does not hold on the last map; else empty
  std::vector<Eigen::Vector3d> tip_path;  ///< map frame, of a proved plan
  std::vector<double> tip_clearance;      ///< of the robot and its loads at each of its points, m
};

/// The independent check of a plan, with what it carries, and of its motion on a map. @throws as check_path
PathVerdict check_taught(const TaughtPlan& taught, const Snapshot& map);

/// How a plan went, in one sentence, with what helps.
std::string sentence_of(const Plan& plan);

struct TeachOptions {
  std::uint64_t seed = 1;       ///< of the planners
  double time_limit = 60.0;     ///< s for each leg
  bool waits_for_plans = true;  ///< an event that needs a plan waits for it; else it is refused as late
  /// Saves the map of that name; empty: an event `save` is refused.
  std::function<void(const std::string& name, const Snapshot& map)> save = {};
  /// Called as the session begins, and as another robot is chosen, with what is to be told of a ball that is
  /// too small; may be empty.
  std::function<void(const std::string& sentence)> note = {};
  /// Called with each event when it is done or refused; may be empty.
  std::function<void(const TaughtEvent&)> report = {};
};

/// A teaching session (Chong et al. 2008, sections 3 and 4) as a state machine: frames come by the fusion
/// that it guides, actions from `next_events`, be it a file, keys or a test; the same frames and events give
/// the same map, plans and report. Strokes go into the active volume. The virtual robot follows the gripper
/// probe and keeps its arm configuration; start and goals are taken where it stands, or as values, and only
/// where its policies call it free. Plans are made beside the frames, on the map as it is when `plan` comes.
/// A plan is approved only if the independent check proves it on the map as it is then.
///
/// From `attach` to `detach` the robot holds a load: a body more wherever it is judged. Each leg carries what
/// was held when its end was picked, from where it begins; another robot holds nothing.
///
/// A stroke from `object` to `object_off` marks an object (marked_object.hpp) and changes no map. Between
/// `start` and an optional `goal`, `pick` takes it where the virtual robot stands and `place` says where it
/// goes: the plan is then plan_pick's, whose legs, voxels and contacts Pick defines, and the check is
/// check_pick. Nothing rides beside it.
///
/// | state | takes |
/// |---|---|
/// | ready, selecting, planned, approved | all but paint_off, erase_off and object_off |
/// | painting | paint_off, undo, undo_stroke, save, quit |
/// | erasing | erase_off, undo, undo_stroke, save, quit |
/// | marking | object_off, undo, save, quit |
/// | planning | quit |
/// | playing | as planned; all but play, approve and save end it |
/// `quit` stops the plan that is being made, if nothing waits for plans; ask_to_end() stops it always.
/// `plan` needs a start and a goal, `play` and `approve` a plan that is proved; `start`, what follows, and
/// `attach` a robot; `detach` a load.
class TeachSession final : public FusionGuide {
 public:
  /// Events that are due at a time (s after the first frame), in order, each handed out once; the time may be
  /// infinite: all that are left.
  using EventSource = std::function<std::vector<TeachEvent>(double until)>;

  TeachSession(EventSource next_events, const TeachOptions& options);
  ~TeachSession() override;

  // FusionGuide
  void begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) override;
  bool before(double since_start) override;
  Brush brush() const override;
  void see(const SeenImage& image) override;
  /// The events that are left, and the plan that is being made.
  void end() override;

  /// From another thread: before the next frame the session quits, with an event. What was to come before it
  /// is left out, and so is a plan that is being made.
  void ask_to_end() { is_stopped_->store(true); }

  TeachState state() const;
  /// Where the virtual robot is to be drawn: led by the probe, or along the plan that is played.
  const VirtualRobot* robot() const { return robot_.get(); }
  Configuration shown_configuration() const;
  /// Why the virtual robot may not be where the probe has it (unreachable, or outside of what its policies
  /// call free), by the last image; empty when it may.
  const std::string& warning() const { return warning_; }
  const std::optional<TaughtPlace>& start() const { return choice_.start; }
  const std::optional<TaughtPlace>& goal() const { return choice_.goal; }  ///< the last one
  std::vector<TaughtPlace> goals() const;                                  ///< all, in order
  const std::vector<Load>& held_loads() const { return choice_.held; }     ///< now
  /// What the virtual robot holds where it is to be drawn: now, or on the leg that is played.
  const std::vector<Load>& shown_loads() const;
  /// The objects that strokes marked, each where it stands now, or on the leg that is played:
  /// map_from_object. What the virtual robot holds then is not among them.
  std::vector<std::pair<const Load*, Eigen::Isometry3d>> standing_objects() const;
  bool has_objects() const { return !choice_.objects.empty(); }  ///< that strokes marked
  bool has_strokes() const;                                      ///< that undo_stroke takes back
  bool wants_place() const { return choice_.pick && !choice_.place; }
  const std::vector<TaughtEvent>& events() const { return done_; }
  const std::deque<TaughtPlan>& plans() const { return plans_; }
  /// The plan of the present start and goals, proved or not; null when there is none.
  const TaughtPlan* last_plan() const;
  /// Rises with whatever changes the map.
  std::size_t map_version() const;
  /// Images in which a robot was led, and of these, in which `warning` was not empty.
  std::size_t led_images() const { return led_images_; }
  /// Times of the events that came more than a second after the source's last image, s after its first frame.
  const std::vector<double>& late_events() const { return late_events_; }
  std::size_t warned_images() const { return warned_images_; }

 private:
  /// What a person chose: undone as a whole.
  struct Choice {
    int volume = 0;
    std::shared_ptr<VirtualRobot> robot;
    std::vector<Load> held;
    std::vector<MarkedObject> objects;
    std::optional<Pick> pick;  ///< its map_from_place counts once a place is chosen
    std::optional<Configuration> grasp, place;
    std::optional<TaughtPlace> start, goal;
    std::vector<TaughtPlace> vias;
    std::optional<std::size_t> plan;    ///< in plans_, of this very choice, proved
    std::optional<std::size_t> failed;  ///< the same, not proved
    bool is_approved = false;
    std::string outdated;  ///< why the last plan is none any more: "'can' was detached"

    void forget_plan();
  };
  static constexpr const char *plan_word = "plan", *approval_word = "approval";  ///< what Undo calls these
  struct Undo {
    std::string what;
    Choice before;
    std::optional<int> stroke;
    bool adds_volume = false;
  };
  /// What became of a plan that was asked for.
  struct Answer {
    std::optional<TaughtPlan> plan;  ///< none: it was refused
    std::string sentence;
    bool is_stopped = false;  ///< before it was there
  };
  struct Job {
    std::future<Answer> result;
    std::optional<Answer> reported{};  ///< already, before an event or the end takes it
    bool is_ready() const {
      return reported || result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }
  };
  struct Played {
    double time;  ///< s after `play`
    Configuration q;
    std::size_t leg = 0;
  };

  [[noreturn]] static void refuse(const std::string& sentence);
  void note_ball() const;
  bool is_asked_to_end() const { return is_stopped_->load() && doing_ != Doing::ended; }
  void apply(const TeachEvent& event);
  std::string refusal_of_state(TeachAction action) const;
  void act(const TeachEvent& event, std::string& remark);
  void save_map(const std::string& name);
  void finish();
  void begin_stroke(const TeachEvent& event, std::string& remark);
  void end_stroke();
  std::string new_conflicts();
  void choose_volume(const TeachEvent& event, std::string& remark);
  void choose_robot(const TeachEvent& event, std::string& remark);
  Eigen::Isometry3d base_at_ball(double time) const;
  void choose_branch(double time, std::string& remark);
  std::string unknown_parts(const PaintedVolume& volume) const;
  std::string cure_of(const Verdict& verdict);
  void choose_place(const TeachEvent& event, std::string& remark);
  void require_begin(const TaughtPlace& begin);
  Configuration place_of(const TeachEvent& event) const;
  void attach(const TeachEvent& event, std::string& remark);
  void detach(const TeachEvent& event, std::string& remark);
  void change_held(const std::string& what, std::vector<Load> held);
  void begin_object(const TeachEvent& event);
  void end_object(std::string& remark);
  void mark(const PaintingSample& sample);
  Load read_load_of(const TeachEvent& event) const;
  /// Refuses a pick with which voxels of another marked object leave the map.
  void require_own_voxels(const Pick& pick, const Snapshot& map) const;
  void choose_pick(const TeachEvent& event, std::string& remark);
  void choose_placing(const TeachEvent& event, std::string& remark);
  void forget_places();
  Verdict check(const Configuration& q, const std::vector<Load>& held);
  void begin_plan(const TeachEvent& event);
  TaughtEvent with_answer(const TaughtEvent& asked, const Answer& answer) const;
  void report_plan();
  TaughtEvent& asked_plan();
  void take_plan(bool wait);
  void stop_plan();
  void play(std::string& remark);
  const Played& played() const;
  void approve(std::string& remark);
  void undo(std::string& remark);
  void undo_stroke(std::string& remark);
  std::string withdraw_plans(std::size_t stroke);
  std::string blocked_places();
  void forget_plan();
  void remember(const std::string& what, std::optional<int> stroke = {});
  void require_robot() const;
  void use_robot(std::shared_ptr<VirtualRobot> robot, double time);
  void see_base(const SeenImage& image);
  std::string not_there(double time) const;
  /// Maps and plans share their names: both may have a folder in maps/.
  bool is_taken(const std::string& name) const;
  TeachState resting_state() const;
  const Snapshot& present_map();

  EventSource next_events_;
  TeachOptions options_;
  const Setup* setup_ = nullptr;
  FreeSpaceMap* map_ = nullptr;
  const FusionCounts* counts_ = nullptr;
  double now_ = 0.0;
  std::size_t other_changes_ = 0;  ///< of the map, by undoing and by new volumes
  std::optional<Snapshot> snapshot_;
  std::size_t snapshot_version_ = 0;

  enum class Doing { nothing, painting, erasing, marking, planning, playing, ended };
  Doing doing_ = Doing::nothing;
  int stroke_ = -1;
  std::size_t conflicts_before_ = 0;  ///< voxels, when the stroke began
  MarkedObject marked_;               ///< that the stroke is about
  std::vector<MarkingBall> balls_;
  std::shared_ptr<VirtualRobot> robot_;
  struct ShownTip {
    Eigen::Isometry3d map_from_tip;
    double time;  ///< s after the first frame
  };
  std::optional<ShownTip> shown_tip_;  ///< by the gripper probe, the last one
  struct ShownBall {
    Eigen::Vector3d center;  ///< map frame
    double bound;            ///< how far it may be off, m
    double time;             ///< s after the first frame
  };
  std::optional<ShownBall> ball_;     ///< the last one that was accepted
  const BoardSetup* base_ = nullptr;  ///< the board that anchors the map; null: there is none
  std::optional<double> base_seen_at_;
  bool is_base_hidden_ = false;  ///< in the last image
  Choice choice_;
  std::deque<Undo> undos_;  ///< the last thousand
  /// Plans end, since the session does.
  const std::shared_ptr<std::atomic<bool>> is_stopped_ = std::make_shared<std::atomic<bool>>(false);
  std::optional<Job> job_;
  std::deque<TaughtPlan> plans_;  ///< which stay where they are
  std::set<std::string> saved_;   ///< maps
  std::vector<TaughtEvent> done_;
  double play_begin_ = 0.0, play_seconds_ = 0.0;
  std::vector<Played> motion_;
  std::vector<std::vector<Load>> carried_;  ///< on each leg that is played
  std::string warning_;
  std::size_t led_images_ = 0, warned_images_ = 0;
  std::vector<double> late_events_;
};

}  // namespace clearway
