#include "common/file_replacement.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

[[noreturn]] void refuseFile(const std::string& path, const std::string& what) {
  throw InputError(path + ": " + what);
}

/// Writes a new file and makes sure that it is on the disk.
void writeThrough(const std::string& path, const std::string& text) {
  constexpr mode_t kPermissions = 0644;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, kPermissions);
  if (file < 0) refuseFile(path, std::string("cannot be written: ") + std::strerror(errno));
  std::size_t written = 0;
  bool is_well = true;
  while (is_well && written < text.size()) {
    const ssize_t count = ::write(file, text.data() + written, text.size() - written);
    is_well = count >= 0 || errno == EINTR;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  is_well = is_well && fsync(file) == 0;
  const int problem = errno;
  is_well = ::close(file) == 0 && is_well;
  if (is_well) return;
  std::remove(path.c_str());
  refuseFile(path, std::string("cannot be written to its end: ") + std::strerror(problem));
}

}  // namespace

void replaceFile(const std::string& path, const std::string& text, Backup backup) {
  namespace fs = std::filesystem;
  std::error_code error;
  // A symbolic link remains one.
  const bool exists = fs::exists(path, error);
  const fs::path target = exists ? fs::canonical(path, error) : fs::path(path);
  if (error) refuseFile(path, "cannot be replaced: " + error.message());
  const std::string written = target.string() + ".new";
  writeThrough(written, text);
  const auto giveUp = [&](const std::string& what) {
    std::remove(written.c_str());
    refuseFile(path, what + ": " + error.message());
  };
  if (exists) {
    const fs::file_status status = fs::status(target, error);
    if (!error) fs::permissions(written, status.permissions(), error);
    if (error) giveUp("cannot keep its permissions");
    if (backup == Backup::kKept) {
      fs::copy_file(target, target.string() + "~", fs::copy_options::overwrite_existing, error);
    }
    if (error) giveUp("cannot be backed up");
  }
  fs::rename(written, target, error);
  if (error) giveUp("cannot be replaced");
  // The new name is on the disk only once the folder is.
  const std::string folder = target.has_parent_path() ? target.parent_path().string() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;
  fsync(descriptor);
  ::close(descriptor);
}

}  // namespace omnitag
