#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>
#include <string_view>

#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "datasets/sources/inflating_stream.hpp"
#include "datasets/sources/rawlog_work.hpp"
#include "datasets/sources/recording.hpp"
#include "datasets/sources/robot_path.hpp"
#include "datasets/sources/sealed_records.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// A file opened for reading, checked to be one we can decode.
class OpenRecording {
 public:
  explicit OpenRecording(const std::filesystem::path& file) : input_(file, "recording") {
    const bool empty = input_.size() == 0;
    if (empty || !begins_like_a_rawlog())
      throw std::invalid_argument("recording " + quote_path(file.string()) + " is " +
                                  (empty ? "empty" : "not an MRPT rawlog") +
                                  "; expected an MRPT rawlog, plain or gz.");
    lseek(descriptor(), 0, SEEK_SET);
  }
  int descriptor() const { return input_.descriptor(); }
  uint64_t size() const { return input_.size(); }

 private:
  /// The first object's head: 0x80 + length of the class name, then the name. As much of it as there is.
  bool begins_like_a_rawlog() const {
    char head[128];
    size_t size = 0;
    if (SealedRecords::are_in(descriptor(), input_.size())) return true;
    InflatingStream stream(descriptor());
    try {
      size = stream.Read(head, sizeof head);
    } catch (const DamagedStream&) {
      return true;  // begins as gz: damage is the decoder's to report
    }
    if (size == 0) return stream.compressed();
    const size_t length = static_cast<unsigned char>(head[0]) & 0x7f;
    if (!(head[0] & 0x80) || length == 0) return false;
    const std::string_view name(head + 1, std::min(size - 1, length));
    return std::all_of(name.begin(), name.end(),
                       [](unsigned char c) { return std::isalnum(c) || c == ':' || c == '_'; });
  }
  InputFile input_;
};

}  // namespace

struct RecordingReader::State {
  explicit State(const std::filesystem::path& name)
      : file(name),
        open(name),
        child(DecodingLimits::of_file(open.size()), open.descriptor(), rawlog_work(open.size())) {}

  std::filesystem::path file;
  OpenRecording open;
  DecodingChild child;
  RobotPath path;
  RecordingCounts counts;
  std::vector<std::string> warnings;
  std::set<std::string> told;  ///< what they say, each once
  std::optional<std::string> damage;
  uint64_t offset = 0;
  bool finished = false;

  void receive();
  void end(const std::string& reason);
  void add(DecodedFrame&& frame);
  void warn(const std::string& what);
  void lose(const std::string& what);
  std::string lost_records;  // the first few
};

void RecordingReader::State::add(DecodedFrame&& frame) {
  size_t* const kinds[] = {&counts.images, &counts.clouds, &counts.odometry, &counts.comments};
  ++*kinds[frame.frame.content.index()];
  path.add(std::move(frame));
}

void RecordingReader::State::warn(const std::string& what) {
  ++counts.skipped;
  const std::string sentence =
      "recording '" + file.string() + "', object " + std::to_string(counts.objects + 1) + ": " + what + ".";
  constexpr size_t enough = 20;
  if (!what.empty() && warnings.size() < enough && told.insert(what).second) warnings.push_back(sentence);
}

void RecordingReader::State::lose(const std::string& what) {
  constexpr size_t reported = 5;
  if (++counts.lost <= reported)
    lost_records += (counts.lost > 1 ? ", " : "") + what + " near byte " + std::to_string(offset);
  const size_t more = counts.lost > reported ? counts.lost - reported : 0;
  damage = "recording " + quote_path(file.string()) +
           " is damaged; what does not pass its checksum is not used: " + lost_records +
           (more > 0 ? " and " + std::to_string(more) + " more" : "") + ".";
}

void RecordingReader::State::end(const std::string& reason) {
  finished = true;
  path.finish();
  if (reason.empty()) {
    offset = open.size();
    return;
  }
  if (damage) {
    damage = damage->substr(0, damage->size() - 1) + "; it ends at object " +
             std::to_string(counts.objects + 1) + ": " + reason + ".";
    return;
  }
  damage = "recording '" + file.string() + "' is damaged at object " + std::to_string(counts.objects + 1) +
           ", near byte " + std::to_string(offset) + " of " + std::to_string(open.size()) + ": " + reason +
           ".";
}

void RecordingReader::State::receive() {
  ChildMessage message = child.receive();
  offset = std::clamp(message.offset, offset, open.size());
  switch (message.kind) {
    case ChildMessage::frame:
      try {
        add(frame_from_bytes(message.text));
      } catch (const std::runtime_error& error) {
        end(error.what());
      }
      break;
    case ChildMessage::object:
      ++counts.objects;
      break;
    case ChildMessage::lost:
      lose(message.text);
      break;
    case ChildMessage::skipped:
      warn(message.text);
      break;
    case ChildMessage::damage:
      end(message.text);
      break;
    case ChildMessage::end:
      end("");
      break;
  }
}

RecordingReader::RecordingReader(const std::filesystem::path& file) : state_(std::make_unique<State>(file)) {}
RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

std::optional<Frame> RecordingReader::next() {
  for (;;) {
    if (auto frame = state_->path.take()) return frame;
    if (state_->finished) return std::nullopt;
    state_->receive();
  }
}

const std::optional<std::string>& RecordingReader::damage() const { return state_->damage; }
const std::vector<std::string>& RecordingReader::warnings() const { return state_->warnings; }
const RecordingCounts& RecordingReader::counts() const { return state_->counts; }
double RecordingReader::progress() const {
  return static_cast<double>(state_->offset) / static_cast<double>(state_->open.size());
}

}  // namespace clearway
