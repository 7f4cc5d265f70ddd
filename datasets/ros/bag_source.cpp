#include "datasets/ros/bag_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <map>
#include <stdexcept>
#include <string_view>

#include "datasets/pictures/picture_times.hpp"
#include "datasets/ros/bag_frames.hpp"
#include "datasets/ros/cut_bag.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/ros/wire_writer.hpp"
#include "datasets/sources/clock_restart.hpp"
#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Libraries below take memory for a chunk (its messages unpacked) and a message's frame.
constexpr std::uint64_t bag_memory = std::uint64_t{3} << 30U;

DecodingLimits limits_of(std::uint64_t bytes) {
  const DecodingLimits limits = DecodingLimits::of_file(bytes);
  return {.memory = std::min(bag_memory, limits.memory), .seconds = limits.seconds};
}

std::unique_ptr<MessageBag> open_messages(const std::filesystem::path& file, int descriptor,
                                          std::uint64_t size) {
  char magic[7] = {};
  const bool has_magic = ::pread(descriptor, magic, 6, 0) == 6;
  if (has_magic && std::string_view(magic).starts_with("#R")) return open_ros1_bag(file);
  const bool is_mcap = has_magic && std::string_view(magic).starts_with("\x89MCAP");
  const bool is_sqlite = has_magic && std::string_view(magic) == "SQLite";
  return is_sqlite || (is_sqlite_bag(file) && !is_mcap) ? open_sqlite_bag(file) : open_mcap(descriptor, size);
}

/// What is wrong with a bag, as one sentence.
std::string sentence(const std::filesystem::path& file, const std::string& clause) {
  return "bag " + quote_path(file.string()) + " " + clause;
}

/// The name without what says that the file is packed.
std::string unpacked_name(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return (kind == ".zstd" || kind == ".zst" ? file.stem() : file.filename()).string();
}

/// The files of a folder with this end of their names, in the order of names, numbers by value. Of a part of
/// SQLite that lies there packed and unpacked, the unpacked one.
std::vector<std::filesystem::path> files_with(const std::filesystem::path& folder, const std::string& kind) {
  std::map<std::string, std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path& file = entry.path();
    if (extension_of(file) == kind || (kind == ".bag" && is_ros1_bag(file)))
      files[file.filename().string()] = file;
    if (kind == ".db3" && is_sqlite_bag(file)) files.try_emplace(unpacked_name(file), file);
  }
  std::vector<std::filesystem::path> list;
  for (const auto& [name, file] : files) list.push_back(file);
  return in_order_of_names(list);
}

/// Several bags, one after the other in the order of their first messages, as one. In the child.
class JoinedBag final : public MessageBag {
 public:
  explicit JoinedBag(const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& file : files) add(file);
    if (parts_.empty()) throw std::runtime_error(damage_);
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const Part& a, const Part& b) { return a.bag->first_time() < b.bag->first_time(); });
  }

  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    done_ = 0;
    bool goes_on = true;
    for (at_ = 0; at_ < parts_.size() && goes_on; ++at_) {
      const Part& part = parts_[at_];
      std::vector<bool> of_part;
      for (const std::size_t topic : part.topics) of_part.push_back(wanted[topic]);
      part.bag->visit(of_part, [&](BagMessage message) {
        message.topic = part.topics[message.topic];
        message.place.part = part.number;
        return goes_on = take(message);
      });
      note_damage(part);
      done_ += part.input->size();
    }
  }
  std::optional<double> first_time() const override {
    for (const Part& part : parts_)  // one without messages comes first
      if (const auto time = part.bag->first_time()) return time;
    return std::nullopt;
  }
  std::uint64_t offset() const override {
    return done_ + (at_ < parts_.size() ? parts_[at_].bag->offset() : 0);
  }

 private:
  struct Part {
    std::string name;
    std::unique_ptr<InputFile> input;
    std::unique_ptr<MessageBag> bag;
    std::vector<std::size_t> topics;  ///< numbers of its topics here
    std::size_t number = 0;           ///< in the order of names
  };

  void add(const std::filesystem::path& file) {
    Part part{quote_path(file.filename().string()), std::make_unique<InputFile>(file, "bag"), nullptr, {}};
    part.number = number_++;
    try {
      part.bag = open_messages(file, part.input->descriptor(), part.input->size());
    } catch (const std::runtime_error& error) {
      if (damage_.empty()) damage_ = "of its " + part.name + ": " + error.what();
      return;  // as one that is not there
    }
    for (const BagTopic& topic : part.bag->topics()) part.topics.push_back(number_of(topic));
    note_damage(part);
    parts_.push_back(std::move(part));
  }
  std::size_t number_of(const BagTopic& topic) {
    const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& known) {
      return known.name == topic.name && known.type == topic.type && known.wire == topic.wire;
    });
    if (found == topics_.end()) {
      topics_.push_back(topic);
      return topics_.size() - 1;
    }
    found->count += topic.count;
    return static_cast<std::size_t>(found - topics_.begin());
  }
  void note_damage(const Part& part) {
    if (damage_.empty() && !part.bag->damage().empty())
      damage_ = "of its " + part.name + ": " + part.bag->damage();
  }

  std::vector<Part> parts_;
  std::size_t number_ = 0, at_ = 0;
  std::uint64_t done_ = 0;  ///< bytes of the parts before
};

/// The files of a bag: one, or those of a folder. @throws std::invalid_argument when there is none to read.
class BagFiles {
 public:
  explicit BagFiles(const std::filesystem::path& bag) : files_{bag} {
    const bool is_folder = is_bag_folder(bag);
    if (is_folder) files_ = files_with(bag, ".mcap");
    if (is_folder && files_.empty()) files_ = files_with(bag, ".db3");
    if (is_folder && files_.empty()) files_ = files_with(bag, ".bag");
    if (is_folder && extension_of(files_.front()) == ".mcap" && !files_with(bag, ".db3").empty())
      throw std::invalid_argument(
          sentence(bag, "has MCAP files and SQLite's (.db3): expected one kind, or one of them by its name"));
    for (const std::filesystem::path& file : files_) {
      inputs_.push_back(std::make_unique<InputFile>(file, "bag"));
      size_ += inputs_.back()->size();
    }
  }

  std::uint64_t size() const { return size_; }
  /// A clause that names those of the parts that are not read; "": all are.
  std::string missing(const std::vector<std::string>& parts) const {
    std::string first;
    std::size_t count = 0;
    for (const std::string& part : parts) {
      const bool is_read = std::any_of(files_.begin(), files_.end(), [&](const auto& file) {
        return unpacked_name(file) == unpacked_name(part);
      });
      if (!is_read && count++ == 0) first = quote(part);
    }
    if (count == 0) return "";
    return "its metadata.yaml lists " + first + ", which is not there" +
           (count > 1 ? ", nor are " + std::to_string(count - 1) + " more" : "") + " as a bag";
  }
  int descriptor() const { return inputs_.front()->descriptor(); }
  /// In the child. @param descriptor of the first file
  std::unique_ptr<MessageBag> open(int descriptor) const {
    if (files_.size() > 1) return std::make_unique<JoinedBag>(files_);
    return open_messages(files_.front(), descriptor, size_);
  }

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<InputFile>> inputs_;
  std::uint64_t size_ = 0;
};

std::string list_of(const std::vector<BagTopic>& topics) {
  std::string list;
  constexpr std::size_t enough = 12;
  for (std::size_t i = 0; i < std::min(topics.size(), enough); ++i)
    list += (i > 0 ? ", " : "") + quote(topics[i].name) + " (" + quote(topics[i].type) + ")";
  if (topics.size() > enough) list += " and " + std::to_string(topics.size() - enough) + " more";
  return list.empty() ? "no topic" : list;
}

/// Those of images and depth.
std::vector<TakenCamera> taken_cameras(const BagTopics& bag) {
  std::vector<TakenCamera> cameras;
  const auto add = [&](const std::string& topic, bool is_rectified, bool is_stated, const char* key) {
    if (topic.empty()) return;
    cameras.push_back(
        {topic, is_rectified, is_stated ? "'" + std::string(key) + "' of the setup" : "its topic's name"});
  };
  add(bag.images, are_images_rectified(bag), bag.rectified.has_value(), "rectified");
  add(bag.depth, is_depth_rectified(bag), bag.depth_rectified.has_value(), "depth_rectified");
  return cameras;
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
        warnings_.push_back(sentence(file_, message.text) + ".");
      } else if (message.kind == ChildMessage::lost) {
        finished_ = true;
        damage_ = sentence(file_, message.text) + ".";
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
    if (!all.empty()) damage_ = sentence(file_, "is damaged: " + all) + ".";
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

/// Refuses a topic that the bag does not have, or not of one of these types. @param by the key of the setup
void require_topic(const std::filesystem::path& file, const std::vector<BagTopic>& topics,
                   const std::string& name, const std::string& by, const std::vector<std::string>& types) {
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&](const BagTopic& topic) { return topic.name == name; });
  const std::string named = " topic " + quote(name) + ", which '" + by + "' of the setup names";
  if (found == topics.end())
    throw std::invalid_argument(sentence(file, "has no" + named + "; it has " + list_of(topics)));
  if (std::find(types.begin(), types.end(), found->type) == types.end())
    throw std::invalid_argument(
        sentence(file, "has " + quote(found->type) + " in" + named + "; expected " + types.front()));
  if (!found->wire)
    throw std::invalid_argument(
        sentence(file, "encodes" + named + ", in another way than CDR and ROS 1, which are known here"));
}

/// Refuses a camera of the setup that would undo the distortion of rectified images once more.
/// @param kind of the keys in 'source: bag:'
void refuse_distortion(const std::filesystem::path& file, const std::string& topic,
                       const std::optional<CameraIntrinsics>& camera, const std::string& kind) {
  if (!camera || !has_distortion(*camera)) return;
  throw std::invalid_argument(sentence(
      file, "has rectified images in topic " + quote(topic) + ", by its name or '" + kind +
                "rectified', and the setup's camera has a distortion; expected the rectified camera "
                "without it, '" +
                kind + "camera_info' in place of it, or '" + kind + "rectified: false' in 'source: bag:'"));
}

/// Refuses what the options name and the bag does not have.
void require_topics(const std::filesystem::path& file, const std::vector<BagTopic>& topics,
                    const SourceOptions& options) {
  const auto require = [&](const std::string& name, const char* key, const std::vector<std::string>& types) {
    if (!name.empty()) require_topic(file, topics, name, std::string("source: bag: ") + key, types);
  };
  const BagTopics& bag = options.bag;
  if (bag.empty())
    throw std::invalid_argument(
        sentence(file,
                 "has several topics and the setup names none: expected 'source: bag:' with 'images', "
                 "'depth', 'clouds' or 'scans'; it has " +
                     list_of(topics)));
  require(bag.images, "images", {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
  require(bag.camera_info, "camera_info", {"sensor_msgs/CameraInfo"});
  require(bag.depth, "depth", {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
  require(bag.depth_camera_info, "depth_camera_info", {"sensor_msgs/CameraInfo"});
  for (const std::string& name : bag.clouds) require(name, "clouds", {"sensor_msgs/PointCloud2"});
  for (const std::string& name : bag.scans) require(name, "scans", {"sensor_msgs/LaserScan"});
  if (!bag.images.empty() && bag.camera_info.empty() && !options.camera)
    throw std::invalid_argument(
        sentence(file, "needs the camera of topic " + quote(bag.images) +
                           ": expected 'camera_info' in 'source: bag:' or 'camera:' in the setup"));
  if (!bag.depth.empty() && bag.depth_camera_info.empty() && !options.depth.camera && !options.camera)
    throw std::invalid_argument(
        sentence(file, "needs the camera of topic " + quote(bag.depth) +
                           ": expected 'depth_camera_info' in 'source: bag:', or 'camera' of 'depth' "
                           "in 'source:', in the setup"));
  if (!bag.images.empty() && are_images_rectified(bag))
    refuse_distortion(file, bag.images, options.camera, "");
  if (!bag.depth.empty() && bag.depth_camera_info.empty() && is_depth_rectified(bag))
    refuse_distortion(file, bag.depth, options.depth.camera ? options.depth.camera : options.camera,
                      "depth_");
}

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
          sentence(file, message.kind == ChildMessage::damage ? message.text : "cannot be read"));
    lines.push_back(
        {message.text[0], message.text.substr(1, end - 1), message.text.substr(end + 1), message.offset});
  }
}

}  // namespace

std::optional<std::string> missing_parts(const std::filesystem::path& folder,
                                         const std::vector<std::string>& parts) {
  const std::string missing = BagFiles(folder).missing(parts);
  if (missing.empty()) return std::nullopt;
  return sentence(folder, "is damaged: " + missing) + ".";
}

std::optional<std::string> bag_damage(const std::filesystem::path& file) {
  const auto lines = ask(file, [](MessageBag& bag, const Tell& tell) {
    bag.visit(std::vector<bool>(bag.topics().size(), true), [](const BagMessage&) { return true; });
    if (!bag.damage().empty()) tell(0, "0" + bag.damage() + '\n');
  });
  if (lines.empty()) return std::nullopt;
  return sentence(file, "is damaged: " + lines.front().first) + ".";
}

std::vector<BagTopic> list_bag(const std::filesystem::path& file) {
  const auto lines = ask(file, [](MessageBag& bag, const Tell& tell) {
    for (const BagTopic& topic : bag.topics()) {
      const char wire = topic.wire == RosWire::ros1 ? '1' : topic.wire == RosWire::cdr ? '2' : '0';
      tell(topic.count, wire + topic.type + '\n' + topic.name);
    }
  });
  std::vector<BagTopic> topics;
  for (const Line& line : lines) {
    topics.push_back({line.second, line.first, std::nullopt, line.number});
    if (line.mark == '1') topics.back().wire = RosWire::ros1;
    if (line.mark == '2') topics.back().wire = RosWire::cdr;
  }
  std::sort(topics.begin(), topics.end(),
            [](const BagTopic& a, const BagTopic& b) { return a.name < b.name; });
  return topics;
}

std::vector<BagFrame> list_frames(const std::filesystem::path& file) {
  const auto lines = ask(file, [](MessageBag& bag, const Tell& tell) {
    for (const BagFrame& frame : frames_of(bag))
      tell(0, (frame.is_fixed ? '1' : '0') + frame.parent + '\n' + frame.name);
  });
  std::vector<BagFrame> frames;
  for (const Line& line : lines) frames.push_back({line.second, line.first, line.mark == '1'});
  return frames;
}

std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& file, const SourceOptions& options) {
  require_topics(file, list_bag(file), options);
  return std::make_unique<BagSource>(file, options);
}

JointStream read_joints(const std::filesystem::path& file, const std::string& topic, double max_gap,
                        const BagTopics& part) {
  require_topic(file, list_bag(file), topic, "robot: joint_topic", {"sensor_msgs/JointState"});
  const BagFiles input(file);
  DecodingChild child(limits_of(input.size()), input.descriptor(),
                      [&](const ChildReport& report, int descriptor) {
                        try {
                          const auto bag = cut_bag(input.open(descriptor), part);
                          visit_joints(*bag, topic, [&](double time, const RosJointState& state) {
                            WireWriter out;
                            out.number(time);
                            out.length(state.names.size());
                            for (const std::string& name : state.names) out.text(name);
                            out.numbers(state.positions);
                            report.send(ChildMessage::skipped, 0, out.message());
                          });
                          report.send(ChildMessage::end, 0, "");
                        } catch (const std::exception&) {
                          report.send(ChildMessage::damage, 0, "");
                        }
                      });
  JointStream stream(max_gap);
  std::vector<double> times;
  for (;;) {
    const ChildMessage message = child.receive();
    if (message.kind != ChildMessage::skipped) break;  // what came before damage is used
    try {
      WireReader in({reinterpret_cast<const std::uint8_t*>(message.text.data()), message.text.size()},
                    RosWire::cdr);
      const auto time = in.number<double>();
      std::vector<std::string> names(in.length(4));
      for (std::string& name : names) name = in.text();
      stream.add(time, names, in.numbers<double>());
      times.push_back(time);
    } catch (const std::exception&) {  // not finite, or of another number than names
    }
  }
  if (stream.empty())
    throw std::invalid_argument(
        sentence(file, "has no joint positions that can be used in topic " + quote(topic)));
  if (find_restart(times))
    throw std::invalid_argument(
        sentence(file, "holds more than one run of its clock: the stamps of topic " + quote(topic) +
                           " jump back and pass the same times again; expected one run: `from` or `to` in "
                           "`source: {bag: …}` of the setup takes a part of it"));
  return stream;
}

}  // namespace clearway
