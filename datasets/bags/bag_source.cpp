#include "datasets/bags/bag_source.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "datasets/bags/bag_files.hpp"
#include "datasets/bags/bag_topics.hpp"
#include "datasets/ros/bag_frames.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "datasets/ros/cut_bag.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/ros/wire_writer.hpp"
#include "datasets/sources/clock_restart.hpp"
#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Libraries below take memory for a chunk (its messages unpacked) and a message's frame.
constexpr std::uint64_t bag_memory = std::uint64_t{3} << 30U;

DecodingLimits limits_of(std::uint64_t bytes) {
  const DecodingLimits limits = DecodingLimits::of_file(bytes);
  return {.memory = std::min(bag_memory, limits.memory), .seconds = limits.seconds};
}

class BagSource final : public FrameSource {
 public:
  BagSource(const std::filesystem::path& file, const SourceOptions& options)
      : file_(file),
        input_(file),
        missing_(input_.missing(options.bag.parts)),
        cameras_(taken_cameras(options.bag)),
        child_(limits_of(input_.size()), input_.descriptor(),
               [this, options](const ChildReport& report, int descriptor) {
                 work(input_, options, report, descriptor);
               }) {}

  std::optional<Frame> next() override {
    while (!finished_) {
      ChildMessage message = child_.receive();
      offset_ = std::max(offset_, message.offset);
      if (message.kind == ChildMessage::frame) {
        try {
          return frame_from_bytes(message.text).frame;
        } catch (const std::runtime_error& error) {
          end(error.what());
        }
      } else if (message.kind == ChildMessage::skipped) {
        warnings_.push_back(bag_sentence(file_, message.text) + ".");
      } else if (message.kind == ChildMessage::lost) {
        finished_ = true;
        damage_ = bag_sentence(file_, message.text) + ".";
      } else {
        end(message.kind == ChildMessage::end ? "" : message.text);
      }
    }
    return std::nullopt;
  }
  std::optional<std::string> damage() const override { return damage_; }
  std::vector<std::string> warnings() const override { return warnings_; }
  std::vector<TakenCamera> cameras() const override { return cameras_; }
  double progress() const override {
    return finished_ ? 1.0 : static_cast<double>(offset_) / static_cast<double>(input_.size());
  }

 private:
  static void work(const BagFiles& files, const SourceOptions& options, const ChildReport& report,
                   int descriptor) {
    std::unique_ptr<MessageBag> bag;
    try {
      bag = cut_bag(files.open(descriptor), options.bag);
      BagFrames frames(*bag, options);
      frames.visit([&](const Frame& frame) {
        report.send(ChildMessage::frame, bag->offset(), frame_to_bytes({frame, true}));
      });
      if (const std::string none = bag->why_none(); !none.empty())
        report.send(ChildMessage::skipped, bag->offset(), none);
      for (const std::string& what : frames.left_out())
        report.send(ChildMessage::skipped, bag->offset(), what);
      const std::string cut = frames.damage();
      const std::string damage = bag->damage() + (bag->damage().empty() || cut.empty() ? "" : "; ") +
                                 (cut.empty() ? "" : "it " + cut);
      if (damage.empty()) return report.send(ChildMessage::end, files.size(), "");
      report.send(ChildMessage::damage, bag->offset(), damage);
    } catch (const ContradictoryBag& error) {
      report.send(ChildMessage::lost, 0, error.what());
    } catch (const std::bad_alloc&) {
      report.send(ChildMessage::damage, 0, "it asks for more memory than it may take");
    } catch (const std::exception& error) {
      report.send(ChildMessage::damage, 0, error.what());
    }
  }

  void end(const std::string& reason) {
    finished_ = true;
    const std::string all = missing_ + (missing_.empty() || reason.empty() ? "" : "; ") + reason;
    if (!all.empty()) damage_ = bag_sentence(file_, "is damaged: " + all) + ".";
  }

  std::filesystem::path file_;
  BagFiles input_;
  std::string missing_;
  std::vector<TakenCamera> cameras_;
  DecodingChild child_;
  std::vector<std::string> warnings_;
  std::optional<std::string> damage_;
  std::uint64_t offset_ = 0;
  bool finished_ = false;
};

/// What the child says of one topic or frame.
struct Line {
  char mark = '0';
  std::string first, second;
  std::uint64_t number = 0;
};
/// Takes a mark, a text, a line break and a text.
using Tell = std::function<void(std::uint64_t number, const std::string& line)>;

/// What `work` tells of a bag, which it reads in a child process with limits.
std::vector<Line> ask(const std::filesystem::path& file,
                      const std::function<void(MessageBag& bag, const Tell& tell)>& work) {
  const BagFiles input(file);
  DecodingChild child(
      limits_of(input.size()), input.descriptor(), [&](const ChildReport& report, int descriptor) {
        try {
          const std::unique_ptr<MessageBag> bag = input.open(descriptor);
          work(*bag, [&](std::uint64_t number, const std::string& line) {
            report.send(ChildMessage::skipped, number, line);
          });
          report.send(ChildMessage::end, 0, "");
        } catch (const std::bad_alloc&) {
          report.send(ChildMessage::damage, 0, "asks for more memory than it may take");
        } catch (const std::exception& error) {
          report.send(ChildMessage::damage, 0, std::string("cannot be read: ") + error.what());
        }
      });
  std::vector<Line> lines;
  for (;;) {
    const ChildMessage message = child.receive();
    const std::size_t end = message.text.find('\n');
    if (message.kind == ChildMessage::end) return lines;
    if (message.kind != ChildMessage::skipped || end == std::string::npos || end == 0)
      throw std::invalid_argument(
          bag_sentence(file, message.kind == ChildMessage::damage ? message.text : "cannot be read"));
    lines.push_back(
        {message.text[0], message.text.substr(1, end - 1), message.text.substr(end + 1), message.offset});
  }
}

void tell_topics(MessageBag& bag, const Tell& tell) {
  for (const BagTopic& topic : bag.topics()) {
    const char wire = topic.wire == RosWire::ros1 ? '1' : topic.wire == RosWire::cdr ? '2' : '0';
    tell(topic.count, wire + topic.type + '\n' + topic.name);
  }
}

/// In the order of their names.
std::vector<BagTopic> topics_of(const std::vector<Line>& lines) {
  std::vector<BagTopic> topics;
  for (const Line& line : lines) {
    if (line.mark < '0' || line.mark > '2') continue;
    topics.push_back({line.second, line.first, std::nullopt, line.number});
    if (line.mark == '1') topics.back().wire = RosWire::ros1;
    if (line.mark == '2') topics.back().wire = RosWire::cdr;
  }
  std::sort(topics.begin(), topics.end(),
            [](const BagTopic& a, const BagTopic& b) { return a.name < b.name; });
  return topics;
}

/// Of each topic its frame and encoding, its clock's offset, when it began and ended, and then its name.
void tell_contents(MessageBag& bag, const Tell& tell) {
  const std::vector<TopicContent> contents = contents_of(bag);
  for (std::size_t i = 0; i < contents.size(); ++i) {
    const auto& [frame, encoding, recorded, offset] = contents[i];
    if (recorded.last < recorded.first) continue;
    tell(i, "f" + frame + '\n' + encoding);
    if (offset) tell(i, "o" + short_text(*offset, 17) + '\n');
    tell(i, "t" + short_text(recorded.first, 17) + '\n' + short_text(recorded.last, 17));
    tell(i, "n\n" + bag.topics()[i].name);
  }
}

std::map<std::string, TopicContent> contents_from(const std::vector<Line>& lines) {
  std::map<std::string, TopicContent> contents;
  TopicContent next;
  for (const Line& line : lines) {
    if (line.mark == 'f') next = {line.first, line.second, {}, {}};
    if (line.mark == 'o') next.clock_offset = finite_number(line.first);
    if (line.mark == 't') {
      next.recorded.first = finite_number(line.first).value_or(0.0);
      next.recorded.last = finite_number(line.second).value_or(0.0);
    }
    if (line.mark == 'n') contents[line.second] = next;
  }
  return contents;
}

}  // namespace

std::optional<std::string> missing_parts(const std::filesystem::path& folder,
                                         const std::vector<std::string>& parts) {
  const std::string missing = BagFiles(folder).missing(parts);
  if (missing.empty()) return std::nullopt;
  return bag_sentence(folder, "is damaged: " + missing) + ".";
}

std::vector<BagTopic> list_bag(const std::filesystem::path& file) {
  return topics_of(ask(file, [](MessageBag& bag, const Tell& tell) {
    if (bag.topics().empty() && !bag.damage().empty()) throw std::runtime_error(bag.damage());
    tell_topics(bag, tell);
  }));
}

BagListing list_contents(const std::filesystem::path& file) {
  const std::vector<Line> lines = ask(file, [](MessageBag& bag, const Tell& tell) {
    tell_topics(bag, tell);
    tell_contents(bag, tell);
    for (const BagFrame& frame : frames_of(bag))
      tell(frame.is_fixed ? 1 : 0, "r" + frame.parent + '\n' + frame.name);
    if (!bag.damage().empty()) tell(0, "d" + bag.damage() + '\n');
  });
  BagListing listing{topics_of(lines), contents_from(lines), {}, std::nullopt};
  for (const Line& line : lines) {
    if (line.mark == 'r') listing.frames.push_back({line.second, line.first, line.number == 1});
    if (line.mark == 'd') listing.damage = bag_sentence(file, "is damaged: " + line.first) + ".";
  }
  return listing;
}

std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& file, const SourceOptions& options) {
  require_topics(file, list_bag(file), options);
  return std::make_unique<BagSource>(file, options);
}

namespace {

/// Adds a message's positions, but for those that are not finite: a driver's sign that it does not know.
void add_known(double time, const std::vector<std::string>& names, const std::vector<double>& positions,
               JointStream& stream) {
  if (names.size() != positions.size()) throw std::invalid_argument("of another number than names");
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::isfinite(positions[i])) stream.add(time, {names[i]}, {positions[i]});
}

}  // namespace

JointStream read_joints(const std::filesystem::path& file, const std::string& topic, double max_gap,
                        const BagTopics& part) {
  require_topic(file, list_bag(file), topic, "robot: joint_topic", {"sensor_msgs/JointState"});
  const BagFiles input(file);
  DecodingChild child(limits_of(input.size()), input.descriptor(),
                      [&](const ChildReport& report, int descriptor) {
                        try {
                          const auto bag = cut_bag(input.open(descriptor), part);
                          visit_joints(*bag, topic, part, [&](double time, const RosJointState& state) {
                            WireWriter out;
                            out.number(time);
                            out.length(state.names.size());
                            for (const std::string& name : state.names) out.text(name);
                            out.numbers(state.positions);
                            report.send(ChildMessage::skipped, 0, out.message());
                          });
                          report.send(ChildMessage::end, 0, bag->why_none());
                        } catch (const std::exception&) {
                          report.send(ChildMessage::damage, 0, "");
                        }
                      });
  JointStream stream(max_gap);
  std::vector<double> times;
  std::string why_none;
  for (;;) {
    const ChildMessage message = child.receive();
    if (message.kind == ChildMessage::end) why_none = message.text;
    if (message.kind != ChildMessage::skipped) break;  // what came before damage is used
    try {
      WireReader in({reinterpret_cast<const std::uint8_t*>(message.text.data()), message.text.size()},
                    RosWire::cdr);
      const auto time = in.number<double>();
      std::vector<std::string> names(in.length(4));
      for (std::string& name : names) name = in.text();
      add_known(time, names, in.numbers<double>(), stream);
      times.push_back(time);
    } catch (const std::exception&) {  // a time that is not finite, or of another number than names
    }
  }
  if (stream.empty())
    throw std::invalid_argument(bag_sentence(file, "has no joint positions that can be used in topic " +
                                                       quote(topic) +
                                                       (why_none.empty() ? "" : ": it " + why_none)));
  if (find_restart(times))
    throw std::invalid_argument(bag_sentence(
        file, "holds more than one run of its clock: the stamps of topic " + quote(topic) +
                  " jump back and pass the same times again; expected one run: `from` or `to` in "
                  "`source: {bag: …}` of the setup takes a part of it"));
  return stream;
}

}  // namespace clearway
