#include "datasets/depth_files/npy_poses.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/npy_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace npy_poses_test {

/// At (1, 2, 3), looking along the world's x: right is -y there, down is -z.
const std::vector<double> first{0, 0, 1, 1, -1, 0, 0, 2, 0, -1, 0, 3, 0, 0, 0, 1};
const std::vector<double> second{1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1};

/// What numpy.save (1.24) wrote of np.asfortranarray of these two, of shape (2, 4, 4) and float32.
const std::string of_numpy =
    std::string("\x93NUMPY\x01\x00v\x00", 10) +
    "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 4, 4), }" + std::string(56, ' ') + "\n" + [] {
      const std::string zero(4, '\0'), one("\0\0\200\077", 4), minus("\0\0\200\277", 4);
      std::string data;
      for (const std::string& number : {zero,
                                        one,
                                        minus,
                                        zero,
                                        zero,
                                        zero,
                                        zero,
                                        zero,  // the first column, of both by turns
                                        zero,
                                        zero,
                                        zero,
                                        one,
                                        minus,
                                        zero,
                                        zero,
                                        zero,  // the second
                                        one,
                                        zero,
                                        zero,
                                        zero,
                                        zero,
                                        one,
                                        zero,
                                        zero,  // the third
                                        one,
                                        std::string("\0\0\200@", 4),
                                        std::string("\0\0\0@", 4),
                                        std::string("\0\0\240@", 4),
                                        std::string("\0\0@@", 4),
                                        std::string("\0\0\300@", 4),
                                        one,
                                        one})
        data += number;
      return data;
    }();

std::vector<double> both(std::size_t numbers) {
  std::vector<double> values(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(numbers));
  values.insert(values.end(), second.begin(), second.begin() + static_cast<std::ptrdiff_t>(numbers));
  return values;
}

void expect_both(const NumberedPoses& numbered, const std::string& what) {
  ASSERT_EQ(numbered.poses.size(), 2U) << what;
  EXPECT_FALSE(numbered.have_numbers);
  const Eigen::Isometry3d ahead = numbered.poses.at(0).value();
  EXPECT_LT((ahead * Eigen::Vector3d(0.1, 0.2, 5) - Eigen::Vector3d(6, 1.9, 2.8)).norm(), 1e-6) << what;
  EXPECT_EQ(numbered.poses.at(1).value().translation(), Eigen::Vector3d(4, 5, 6)) << what;
}

TEST(NpyPoses, AreTheSameInEachShape) {
  for (const auto& [shape, numbers] :
       {std::pair("(2, 4, 4)", 16U), {"(2, 3, 4)", 12U}, {"(2, 16)", 16U}, {"(2, 12)", 12U}}) {
    const std::vector<double> values = both(numbers);
    expect_both(parse_npy_poses(npy_bytes("<f8", shape, values), "p"), shape);
    expect_both(
        parse_npy_poses(npy_bytes("<f4", shape, std::vector<float>(values.begin(), values.end())), "p"),
        shape);
  }
  expect_both(parse_npy_poses(of_numpy, "p"), "Fortran's order");
}

TEST(NpyPoses, OneAloneIsThatOfItsPicture) {
  EXPECT_EQ(parse_npy_pose(npy_bytes("<f8", "(4, 4)", second), "p")->translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(parse_npy_pose(npy_bytes("<f8", "(1, 4, 4)", second), "p")->translation(),
            Eigen::Vector3d(4, 5, 6));
  EXPECT_NE(complaint([&] { parse_npy_pose(of_numpy, "p"); }).find("it has 2 poses, expected one"),
            std::string::npos);
}

TEST(NpyPoses, WhatIsNotFiniteIsNotKnownAndWhatInvertingLeavesIsNothing) {
  std::vector<double> values = both(16);
  values[3] = NAN;
  values[28] = 1e-17;
  const auto numbered = parse_npy_poses(npy_bytes("<f8", "(2, 4, 4)", values), "p");
  EXPECT_FALSE(numbered.poses.at(0));
  EXPECT_TRUE(numbered.poses.at(1));
}

TEST(NpyPoses, WhatIsNoneIsRefusedInOneSentence) {
  const auto said = [](const std::string& bytes) {
    return complaint([&] { parse_npy_poses(bytes, "poses 'p'"); });
  };
  std::vector<double> transposed(16);
  for (std::size_t i = 0; i < 16; ++i) transposed[i % 4 * 4 + i / 4] = second[i];
  std::vector<double> scaled = both(16);
  scaled[16] = 2.0;
  for (const auto& [bytes, expected] :
       {std::pair<std::string, std::string>{npy_bytes("<f8", "(1, 4, 4)", transposed),
                                            "poses 'p', matrix 0 is no rigid transform"},
        {npy_bytes("<f8", "(2, 4, 4)", scaled), "matrix 1 is no rigid transform"},
        {npy_bytes("<f8", "(8, 4)", both(16)), "it is an array of 8 x 4 entries, expected N x 4 x 4"},
        {npy_bytes("<f8", "(2, 7)", std::vector<double>(14)), "it is an array of 2 x 7 entries"},
        {npy_bytes("<f8", "(32,)", both(16)), "it is an array of 32 entries"},
        {npy_bytes("<f8", "(0, 4, 4)", std::vector<double>()), "expected at least one pose"},
        {npy_bytes("<i8", "(1, 16)", std::vector<std::int64_t>(16)), "its numbers are of the type 'i8'"},
        {npy_bytes("<f8", "(9999999999, 4, 4)", second), "expected at most 16777216"},
        {of_numpy.substr(0, 200), "it is cut off"},
        {"\x93NUMPY", "it is cut off"}})
    EXPECT_NE(said(bytes).find(expected), std::string::npos) << said(bytes);
  for (std::size_t size = 6; size < of_numpy.size(); ++size) EXPECT_NE(said(of_numpy.substr(0, size)), "");
}

TEST(NpyPoses, HaveTheTimesThatLieBesideThem) {
  const TemporaryFolder folder;
  std::vector<std::string> notes;
  const auto times = [&]() { return times_of_npy_poses(folder / "poses.npy", 2, notes); };
  EXPECT_TRUE(times().empty());
  folder.write("times.txt", "0 1305031102.25\n");  // of pictures, by their numbers
  EXPECT_TRUE(times().empty());
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("times.txt', line 1: expected one number, the time of a pose; they are not used"),
            std::string::npos)
      << notes[0];
  folder.write("timestamps.txt", "# s\n1305031102.25\n1305031102.75\n");
  const std::vector<double> expected{1305031102.25, 1305031102.75};
  EXPECT_EQ(times(), expected);
  folder.write("poses_times.npy",
               npy_bytes("<i8", "(2,)", std::vector<std::int64_t>{1305031102250000000, 1305031102750000000}));
  folder.write("timestamps.txt", "9\n");
  const std::vector<double> of_nanoseconds = times();
  ASSERT_EQ(of_nanoseconds.size(), 2U);
  for (const std::size_t i : {0U, 1U}) EXPECT_NEAR(of_nanoseconds[i], expected[i], 1e-6);
  const auto said = [&](const std::string& bytes) {
    folder.write("poses_times.npy", bytes);
    return complaint([&] { times(); });
  };
  for (const auto& [bytes, why] :
       {std::pair<std::string, std::string>{npy_bytes("<f8", "(3,)", std::vector<double>{1, 2, 3}),
                                            "it has 3 times for 2 poses"},
        {npy_bytes("<f8", "(2,)", std::vector<double>{2, 1}), "do not rise"},
        {npy_bytes("<f8", "(2,)", std::vector<double>{1, NAN}), "do not rise"},
        {npy_bytes("<f4", "(2,)", std::vector<float>{1305031102.F, 1305031202.F}), "too coarse"},
        {npy_bytes("<f8", "(1, 2)", std::vector<double>{1, 2}), "an array of 1 x 2 entries"},
        {"1 2\n", "line 1: expected one number"}})
    EXPECT_NE(said(bytes).find(why), std::string::npos) << said(bytes);
}

}  // namespace npy_poses_test
}  // namespace clearway
