#pragma once

#include <string>

namespace omnitag {

/// Whether the old file is kept, with "~" at the end of its name.
enum class Backup { kKept, kNone };

/// Replaces a file as a whole or not at all: writes beside it, syncs, and renames. Throws
/// InputError if that fails; the file is then unchanged.
void replaceFile(const std::string& path, const std::string& text, Backup backup = Backup::kKept);

}  // namespace omnitag
