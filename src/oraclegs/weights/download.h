#pragma once
// A file from a server: interrupted and continued, compared with its checksum, and under its name only when whole.

#include <cstdint>
#include <filesystem>
#include <string>

#include "oraclegs/core/progress.h"

namespace oraclegs {

struct DownloadRequest {
  std::string url;
  std::filesystem::path to;  ///< the folder is made; what has arrived so far is in TO.part
  std::string bearer = {};   ///< for the server of `url` alone
  std::string sha256 = {};   ///< empty = the one that the server sends (x-linked-etag, as Hugging Face does)
  uint64_t bytes = 0;        ///< 0 = likewise
  std::string stage = {};    ///< name that progress events carry
};

/// Continues from TO.part where the server can, else begins anew; goes on by itself after a lost connection as long as
/// something arrives. Ends with TO in place, flushed; its checksum was right, or a Warning said that none is known.
/// Throws InputError (the address does not exist, or needs an account or an agreement), RunError (no network, wrong
/// checksum, disk full, another process is at it), Interrupted. TO.part stays for the next time, except where it is
/// wrong.
void Download(const DownloadRequest& request, const Listener& listener);

}  // namespace oraclegs
