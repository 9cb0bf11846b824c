#pragma once

#include <string>

namespace omnitag {

/// Whether what was there stays, with "~" at the end of its name.
enum class Backup { kKept, kNone };

/// Replaces a file as a whole or not at all: writes beside it, syncs, and renames. Throws
/// InputError where that cannot be done; the file is then as it was.
void replaceFile(const std::string& path, const std::string& text, Backup backup = Backup::kKept);

}  // namespace omnitag
