#include "apps/compare/worst_case_pages.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "apps/compare/problem_server.hpp"
#include "apps/compare/worker_process.hpp"
#include "apps/results/compare_worst.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// A server in this process or another, which is asked for one page after the other.
class PageDrawer {
 public:
  PageDrawer(const Suite& suite, const PreparedExperiment& experiment, const CompareChoice& choice)
      : suite_(suite), experiment_(experiment), choice_(choice) {}

  /// What became of the request; `failed` in a sentence where its process ended or took too long.
  ProblemReply draw(const ProblemRequest& request) {
    ProblemReply last{ProblemReply::Kind::failed};
    if (!choice_.isolation.is_on) {
      if (!server_) server_ = make_problem_server(suite_, experiment_, choice_);
      server_->answer(request, [&](const ProblemReply& reply) { last = reply; });
      return last;
    }
    if (!worker_) worker_ = std::make_unique<WorkerProcess>(service());
    worker_->ask(to_bytes(request));
    const auto end = Clock::now() + std::chrono::duration<double>(choice_.isolation.grace);
    while (Clock::now() < end) {
      pollfd waiting{worker_->descriptor(), POLLIN, 0};
      constexpr int a_second = 1000;
      if (::poll(&waiting, 1, a_second) <= 0) continue;
      for (const std::string& bytes : worker_->replies()) return reply_of_bytes(bytes);
      if (!worker_->has_ended()) continue;
      last.sentence = "its process " + worker_->how_it_ended();
      worker_.reset();
      return last;
    }
    worker_.reset();
    last.sentence = "it took too long";
    return last;
  }

 private:
  WorkerProcess::Serve service() const {
    return [this, server = std::shared_ptr<ProblemServer>()](std::string_view bytes,
                                                             const WorkerProcess::Reply& reply) mutable {
      if (!server) server = make_problem_server(suite_, experiment_, choice_);
      server->answer(request_of_bytes(bytes), [&](const ProblemReply& sent) { reply(to_bytes(sent)); });
    };
  }

  const Suite& suite_;
  const PreparedExperiment& experiment_;
  const CompareChoice& choice_;
  std::unique_ptr<ProblemServer> server_;  ///< without isolation
  std::unique_ptr<WorkerProcess> worker_;
};

}  // namespace

void draw_worst_pages(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                      const CompareChoice& choice, const CompareRecords& records, Console& console) {
  const CompareExperiment found = records.experiment(index);
  const auto places = records.places(index);
  std::vector<WorstPage> pages = worst_pages(found, static_cast<std::size_t>(choice.worst_pages));
  // Worlds one after the other: a server holds one at a time.
  std::stable_sort(pages.begin(), pages.end(), [&](const WorstPage& a, const WorstPage& b) {
    return places[a.problem].first < places[b.problem].first;
  });
  PageDrawer drawer(suite, experiment, choice);
  for (const WorstPage& page : pages) {
    const CompareProblem& problem = found.problems[page.problem];
    const auto [stage, place] = places[page.problem];
    const fs::path file = choice.out / worst_page_file(found, problem, page.number);
    if (fs::exists(file)) continue;  // drawn before an interruption
    const ProblemReply reply = drawer.draw({.stage = stage, .problem = place, .drawn_number = page.number});
    if (reply.kind != ProblemReply::Kind::finished || reply.files.size() != 1) {
      console.warn("clearway: experiment '" + found.setup.name + "', problem '" + problem.name +
                   "': no page of this worst case: " + reply.sentence);
      continue;
    }
    make_folder_of(file);
    save_file(file, reply.files.begin()->second);
  }
}

}  // namespace clearway
