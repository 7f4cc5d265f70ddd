#include "apps/compare/problem_server.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/compare/compare_team.hpp"
#include "apps/compare/left_processes.hpp"
#include "apps/compare/line_process.hpp"
#include "apps/compare/robot_server.hpp"
#include "apps/compare/worker_process.hpp"
#include "apps/console/parse.hpp"
#include "apps/results/compare_record.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

std::string cbor_bytes(const Json& json) {
  std::string bytes;
  Json::to_cbor(json, bytes);
  return bytes;
}

Json json_of_cbor(std::string_view bytes) { return Json::from_cbor(bytes.begin(), bytes.end()); }

/// First byte of each part that a run's process sends.
constexpr char sent_part = 'P', sent_refusal = 'R', sent_shortage = 'M';
constexpr int out_of_memory_status = 77;
constexpr double longest_wait = 2e6;  ///< s: what poll() can wait

[[noreturn]] void end_out_of_memory() { ::_exit(out_of_memory_status); }

void run_in_own_process(const PartedWork& work, const SendPart& send) {
  std::set_new_handler(end_out_of_memory);  // whoever asked, and whatever it would make of a refusal
  try {
    work([&](std::string_view part) { send(sent_part + std::string(part)); });
  } catch (const std::invalid_argument& refusal) {
    send(sent_refusal + std::string(refusal.what()));
  } catch (const ProgramOutOfMemory& shortage) {
    send(sent_shortage + std::string(shortage.what()));
  }
}

IsolatedEnd end_of(const ChildOutcome& outcome, const CompareIsolation& isolation, double seconds) {
  IsolatedEnd end;
  for (const std::string& part : outcome.parts) {
    if (part[0] == sent_refusal) throw std::invalid_argument(part.substr(1));
    if (part[0] == sent_shortage) {
      end.ended = "out_of_memory";
      end.explanation =
          "The run may take " + significant(isolation.memory / 1e9) + " GB: " + ended(part.substr(1));
      return end;
    }
    end.parts.push_back(part.substr(1));
  }
  if (outcome.finished) return end;
  const bool was_killed = WIFSIGNALED(outcome.status) && WTERMSIG(outcome.status) == SIGKILL;
  const bool is_too_large = outcome.is_out_of_memory || (WIFEXITED(outcome.status) &&
                                                         WEXITSTATUS(outcome.status) == out_of_memory_status);
  const bool threw = !outcome.is_late && WIFEXITED(outcome.status) && outcome.failure != "its reader crashed";
  if (outcome.is_late) {
    end.ended = "hung";
    end.explanation = "The run, with its check and its motion, did not end within " + significant(seconds) +
                      " s, its time limit and what is granted beyond, and was stopped.";
  } else if (is_too_large) {
    end.ended = "out_of_memory";
    end.explanation =
        "The run asked for more than the " + significant(isolation.memory / 1e9) + " GB that it may take.";
  } else if (was_killed) {
    end.ended = "out_of_memory";
    end.explanation = "The run's process was killed (SIGKILL), as the system does when memory is short.";
  } else {
    end.ended = "crashed";
    end.explanation = threw ? "The run ended with an error: " + ended(outcome.failure)
                            : "The run's process " + end_of_process(outcome.status) + ".";
  }
  return end;
}

}  // namespace

IsolatedEnd run_isolated(const PartedWork& work, const CompareIsolation& isolation, double seconds) {
  IsolatedEnd end;
  if (!isolation.is_on) {
    work([&](std::string_view part) { end.parts.emplace_back(part); });
    return end;
  }
  const LeftProcesses left_by_an_external_planner;
  const ChildLimits limits{static_cast<std::size_t>(isolation.memory), std::size_t{1} << 30U,
                           static_cast<int>(std::ceil(std::min(seconds, longest_wait)))};
  return end_of(run_in_child([&](const SendPart& send) { run_in_own_process(work, send); }, limits),
                isolation, seconds);
}

std::string to_bytes(const ProblemRequest& request) {
  Json json = {{"stage", request.stage},
               {"have", request.have},
               {"wanted_not", request.wanted_not},
               {"unsafe", request.unsafe}};
  if (request.problem) json["problem"] = *request.problem;
  if (request.drawn_number) json["drawn_number"] = *request.drawn_number;
  return cbor_bytes(json);
}

ProblemRequest request_of_bytes(std::string_view bytes) {
  const Json json = json_of_cbor(bytes);
  ProblemRequest request;
  json.at("stage").get_to(request.stage);
  if (json.contains("problem")) request.problem = json.at("problem").get<std::size_t>();
  if (json.contains("drawn_number")) request.drawn_number = json.at("drawn_number").get<int>();
  json.at("have").get_to(request.have);
  json.at("wanted_not").get_to(request.wanted_not);
  json.at("unsafe").get_to(request.unsafe);
  return request;
}

std::string to_bytes(const ProblemReply& reply) {
  Json problems = Json::array(), files = Json::array();
  for (const CompareProblem& problem : reply.problems) problems.push_back(record_of(problem));
  for (const auto& [name, bytes] : reply.files)
    files.push_back({name, Json::binary({bytes.begin(), bytes.end()})});
  Json json = {{"kind", static_cast<int>(reply.kind)},
               {"problems", problems},
               {"planner", reply.planner},
               {"files", files},
               {"page", reply.page},
               {"sentence", reply.sentence}};
  if (reply.run) json["run"] = record_of(*reply.run);
  return cbor_bytes(json);
}

ProblemReply reply_of_bytes(std::string_view bytes) {
  const Json json = json_of_cbor(bytes);
  ProblemReply reply{static_cast<ProblemReply::Kind>(json.at("kind").get<int>())};
  for (const Json& problem : json.at("problems")) reply.problems.push_back(problem_of_record(problem));
  json.at("planner").get_to(reply.planner);
  if (json.contains("run")) reply.run = run_of_record(json.at("run"));
  for (const Json& file : json.at("files")) {
    const auto& content = file.at(1).get_binary();
    reply.files.emplace(file.at(0).get<std::string>(), std::string(content.begin(), content.end()));
  }
  json.at("page").get_to(reply.page);
  json.at("sentence").get_to(reply.sentence);
  return reply;
}

void ProblemServer::answer(const ProblemRequest& request, const Send& send) {
  try {
    if (request.drawn_number) {
      draw(request, send);
    } else if (request.problem) {
      plan(request, send);
    } else {
      open(request.stage, send);
    }
  } catch (const std::invalid_argument& error) {
    send({.kind = ProblemReply::Kind::bad_input, .sentence = error.what()});
  } catch (const DamagedFile& error) {
    send({.kind = ProblemReply::Kind::damaged, .sentence = error.what()});
  } catch (const std::runtime_error& error) {
    send({.kind = ProblemReply::Kind::failed, .sentence = error.what()});
  }
}

std::unique_ptr<ProblemServer> make_problem_server(const Suite& suite, const PreparedExperiment& experiment,
                                                   const CompareChoice& choice) {
  if (experiment.setup.teams) return make_team_server(suite, experiment, choice);
  return make_robot_server(suite, experiment, choice);
}

}  // namespace clearway
