#pragma once

namespace clearway {

/// From now on the calls of this process that change files or folders are counted: opening to write, write,
/// ftruncate, fsync, fdatasync, rename, mkdir and link. The `number`th, from 1, fails with `error`, or, where
/// `error` is 0, the process is killed before it. Number 0: none fails.
/// The library that this belongs to stands between the program and libc.
void fail_disk_call(long number, int error);

/// Calls counted since.
long disk_calls();

}  // namespace clearway
