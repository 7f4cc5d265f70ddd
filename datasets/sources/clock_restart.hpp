#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace clearway {

/// Where the times of one stream of messages start again, as those of a simulator that was reset, or of a
/// recording that is played in a loop: the first message after a jump back by more than a second (as tf2
/// looks for one) from which on at least three messages in order lie within times that were passed before.
/// Single late messages, streams without order (a jump in every fourth message, or a tenth of the span back
/// per message) and parts that are only in another order than their times are no restart. Nothing: there is
/// none.
/// @param times s, in the order of the messages
std::optional<std::size_t> find_restart(std::span<const double> times);

/// Where the clock of a stream was set back by more than the stream had run, or so near its end that hardly a
/// time is passed again: the first message after a step back of more than a second, from which on none comes
/// up to what had been reached. By such times the newest messages would be the oldest. What is not in order
/// before and after, as a shuffled or reversed stream, late messages, which lack before, and one or two wrong
/// ones are no step.
/// Nothing: there is none.
/// @param times s, in the order of the messages
std::optional<std::size_t> find_set_back(std::span<const double> times);

/// Whether no message is behind those before it by more than a second.
bool is_one_run(std::span<const double> times);

/// That a stream is not of one run of its clock, as a clause that says what to do.
/// @param name of the stream @param what its times are: "the stamps" @param restart of find_restart
/// @param cut s, with which `to` and `from` of the setup part the runs; nothing: they do not
std::string restart_clause(const std::string& name, std::span<const double> times, const char* what,
                           std::size_t restart, std::optional<double> cut);

/// "the stamps of NAME jump back by 37 s at message 38 of 40, as of a clock that was set back, …"
/// @param step of find_set_back
std::string set_back_clause(const std::string& name, std::span<const double> times, const char* what,
                            std::size_t step);

}  // namespace clearway
