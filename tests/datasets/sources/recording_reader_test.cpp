#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <random>
#include <thread>

#include "datasets/sources/record_seal.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/mutated_bytes.hpp"
#include "tests/worlds/sample_frames.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace recording_reader_test {

struct SmallLog {
  std::string gz, plain;
  std::vector<size_t> ends;         ///< bytes of the gz log up to the end of each frame
  std::vector<std::string> frames;  ///< as read from the whole log
};

std::string unpacked(const std::filesystem::path& file) {
  gzFile in = gzopen(file.c_str(), "rb");
  std::string bytes(1 << 20, '\0');
  bytes.resize(static_cast<size_t>(gzread(in, bytes.data(), static_cast<unsigned>(bytes.size()))));
  gzclose(in);
  return bytes;
}

SmallLog small_log(const TemporaryFolder& folder) {
  SmallLog log;
  const auto file = folder / "small.rawlog";
  std::mt19937 random(11);
  RecordingWriter writer(file);
  for (const auto& frame : sample_frames()) writer.write(frame);
  writer.write(1001, "depth", sample_depth(random, 6, 5));
  writer.finish();
  log.gz = read_file(file);
  for (size_t at = 0; at < log.gz.size();) {
    const RecordSeal seal = seal_of(std::string_view(log.gz).substr(at)).value();
    at += seal.size;
    if (!seal.is_end) log.ends.push_back(at);
  }
  log.plain = unpacked(file);
  RecordingReader reader(file);
  for (const auto& frame : read_all(reader)) log.frames.push_back(bytes_of(frame));
  return log;
}

/// The frames a reader gives for these bytes, and its verdict.
struct Reading {
  std::vector<std::string> frames;
  std::optional<std::string> damage;
};
Reading read_bytes(const TemporaryFolder& folder, const std::string& bytes) {
  write_file(folder / "damaged.rawlog", bytes);
  RecordingReader reader(folder / "damaged.rawlog");
  Reading reading;
  for (const auto& frame : read_all(reader)) reading.frames.push_back(bytes_of(frame));
  reading.damage = reader.damage();
  return reading;
}

void expect_beginning_of(const std::vector<std::string>& whole, const std::vector<std::string>& part) {
  ASSERT_LE(part.size(), whole.size());
  EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
}

TEST(RecordingReader, ReportsACutAtAnyLengthAndKeepsTheFramesBefore) {
  const TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  ASSERT_EQ(log.frames.size(), log.ends.size());
  const size_t stride = mutations(600) < 10000 ? 19 : 1;  // round the ends of frames every length
  const auto is_near = [&](size_t length) {
    return std::any_of(log.ends.begin(), log.ends.end(),
                       [&](size_t end) { return end <= length + 4 && length <= end + 4; });
  };
  for (size_t length = 1; length < log.gz.size(); ++length) {
    if (length % stride != 0 && !is_near(length)) continue;
    const Reading reading = read_bytes(folder, log.gz.substr(0, length));
    EXPECT_TRUE(reading.damage) << "cut to " << length << " of " << log.gz.size();
    const size_t whole =
        static_cast<size_t>(std::upper_bound(log.ends.begin(), log.ends.end(), length) - log.ends.begin());
    EXPECT_GE(reading.frames.size(), whole) << "cut to " << length;
    expect_beginning_of(log.frames, reading.frames);
  }
  EXPECT_FALSE(read_bytes(folder, log.gz).damage);
}

TEST(RecordingReader, NamesFileObjectAndPlaceOfDamage) {
  const TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  const auto damage = *read_bytes(folder, log.gz.substr(0, log.ends[1] + 20)).damage;
  EXPECT_NE(damage.find("damaged.rawlog"), std::string::npos) << damage;
  EXPECT_NE(damage.find("object 3"), std::string::npos) << damage;
  EXPECT_NE(damage.find("near byte"), std::string::npos) << damage;
  EXPECT_EQ(std::count(damage.begin(), damage.end(), '\n'), 0) << damage;
}

TEST(RecordingReader, NoFlippedBitOfAGzLogIsTakenForAnotherRecording) {
  const TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  std::mt19937 random(5);
  int damaged = 0;
  const int trials = mutations(60);
  for (int trial = 0; trial < trials; ++trial) {
    std::string bytes = log.gz;
    const size_t at = 2 + random() % (bytes.size() - 2);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    Reading reading;
    if (!complaint([&] { reading = read_bytes(folder, bytes); }).empty()) continue;
    damaged += reading.damage.has_value();
    if (!reading.damage) {
      EXPECT_EQ(reading.frames, log.frames) << "byte " << at;
    }
  }
  EXPECT_GT(damaged, trials * 95 / 100);
}

TEST(RecordingReader, SurvivesWhateverAPlainLogHolds) {
  const TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  std::mt19937 random(6);
  for (int trial = 0; trial < mutations(60); ++trial) {
    std::string bytes = log.plain;
    for (int flips = 1 + static_cast<int>(random() % 4); flips > 0; --flips)
      bytes[random() % bytes.size()] = static_cast<char>(trial % 3 == 0 ? 0xff : random());
    const std::string refused = complaint([&] { read_bytes(folder, bytes); });
    if (!refused.empty()) {
      EXPECT_NE(refused.find("not an MRPT rawlog"), std::string::npos) << refused;
    }
  }
}

TEST(RecordingReader, AHugeSizeInALogIsDamageAndNotHugeMemory) {
  const TemporaryFolder folder;
  SmallLog log = small_log(folder);
  // The class name is followed by the observation's fields; every run of four bytes becomes a huge number.
  const size_t apart = mutations(60) < 10000 ? 25 : 9;
  for (size_t at = 20; at + 4 < log.plain.size(); at += apart) {
    std::string bytes = log.plain;
    bytes.replace(at, 4, "\xff\xff\xff\x7f");
    (void)complaint([&] { read_bytes(folder, bytes); });
  }
}

TEST(RecordingReader, ReadsPlainLogsAndLogsOfSeveralGzMembers) {
  const TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  const Reading plain = read_bytes(folder, log.plain);
  EXPECT_FALSE(plain.damage);
  EXPECT_EQ(plain.frames, log.frames);
  const Reading twice = read_bytes(folder, log.gz + log.gz);
  EXPECT_FALSE(twice.damage);
  EXPECT_EQ(twice.frames.size(), 2 * log.frames.size());
  const Reading cut = read_bytes(folder, log.gz + log.gz.substr(0, log.gz.size() - 3));
  EXPECT_TRUE(cut.damage);
  EXPECT_EQ(cut.frames.size(), 2 * log.frames.size());
  const Reading trailing = read_bytes(folder, log.gz + "more");
  EXPECT_TRUE(trailing.damage);
  EXPECT_EQ(trailing.frames, log.frames);
}

TEST(RecordingReader, AnUnknownClassIsDamageAndNotTheEnd) {
  const TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  std::string bytes = log.plain;
  const auto second = bytes.find("CObservationImage");
  bytes.replace(second, 17, "CObservationImagd");
  const Reading reading = read_bytes(folder, bytes);
  EXPECT_EQ(reading.frames.size(), 1u);
  ASSERT_TRUE(reading.damage);
  EXPECT_NE(reading.damage->find("object 2"), std::string::npos) << *reading.damage;
}

/// A fuzzer's find: MRPT repeats the name of a class that it does not know.
TEST(RecordingReader, WhatMrptRepeatsOfAFileCannotCommandATerminal) {
  const TemporaryFolder folder;
  const std::string name = "CObservation\x1b[2J" + std::string(100, 'x');
  const std::string object = static_cast<char>(0x80 + name.size()) + name + std::string(40, '\0');
  const Reading reading = read_bytes(folder, sealed_record(object, {.index = 0, .time = 1.0}) +
                                                 sealed_record("", {.index = 1, .is_end = true}));
  ASSERT_TRUE(reading.damage);
  EXPECT_TRUE(std::none_of(reading.damage->begin(), reading.damage->end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20;
  })) << *reading.damage;
  EXPECT_NE(reading.damage->find("x1b[2J"), std::string::npos) << *reading.damage;
}

TEST(RecordingReader, RefusesWhatIsNoRecordingInOneSentence) {
  const TemporaryFolder folder;
  EXPECT_NE(complaint([&] { RecordingReader(folder / "missing.rawlog"); }).find("missing.rawlog"),
            std::string::npos);
  EXPECT_NE(complaint([&] { RecordingReader(folder / "."); }).find("it is a folder"), std::string::npos);
  EXPECT_NE(complaint([&] { read_bytes(folder, ""); }).find("empty"), std::string::npos);
  EXPECT_NE(complaint([&] { read_bytes(folder, "boards: []\n"); }).find("not an MRPT rawlog"),
            std::string::npos);
}

TEST(RecordingReader, ReadsOnWhenTheThreadThatOpenedItHasEnded) {
  TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  std::optional<RecordingReader> reader;
  std::vector<std::string> frames;
  std::thread([&] {
    reader.emplace(folder / "small.rawlog");
    frames.push_back(bytes_of(*reader->next()));
  }).join();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  while (const auto frame = reader->next()) frames.push_back(bytes_of(*frame));
  EXPECT_EQ(reader->damage(), std::nullopt);
  EXPECT_EQ(frames, log.frames);
}

/// Reads the small log in a child after `before`; whether it got all frames.
bool reads_all_after(const TemporaryFolder& folder, const SmallLog& log,
                     const std::function<void()>& before) {
  const pid_t child = fork();
  if (child == 0) {
    before();
    RecordingReader reader(folder / "small.rawlog");
    std::size_t frames = 0;
    while (reader.next()) ++frames;
    _exit(frames == log.frames.size() && !reader.damage() ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(RecordingReader, ReadsInAProgramWithoutStandardStreams) {
  TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  for (const std::vector<int>& closed : {std::vector{0}, {1}, {0, 1}, {0, 1, 2}}) {
    EXPECT_TRUE(reads_all_after(folder, log, [&] {
      for (const int stream : closed) close(stream);
    })) << closed.size();
  }
}

TEST(RecordingReader, ItsDecoderIgnoresASignalThatTheProgramIgnores) {
  TemporaryFolder folder;
  const SmallLog log = small_log(folder);
  EXPECT_TRUE(reads_all_after(folder, log, [] {
    setpgid(0, 0);
    std::signal(SIGHUP, SIG_IGN);
    std::thread([] {
      for (int i = 0; i < 20; ++i) {
        kill(0, SIGHUP);  // to the decoder, too
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    }).detach();
  }));
}

TEST(RecordingReader, MayBeDroppedHalfway) {
  const TemporaryFolder folder;
  std::mt19937 random(1);
  RecordingWriter writer(folder / "long.rawlog");
  for (int i = 0; i < 50; ++i) writer.write(Frame{i + 1.0, "camera", sample_image(random, 320, 240)});
  writer.finish();
  for (int i = 0; i < 5; ++i) {
    RecordingReader reader(folder / "long.rawlog");
    EXPECT_TRUE(reader.next());
  }
  RecordingReader first(folder / "long.rawlog"), second(folder / "long.rawlog");
  first = std::move(second);
  EXPECT_EQ(read_all(first).size(), 50u);
}

}  // namespace recording_reader_test
}  // namespace clearway
