// Fast DDS's shared memory that nobody uses any more: what processes leave in /dev/shm when they are killed.
#pragma once

#include <cstddef>

namespace coppice {

/// Removes the segments, ports and locks that no living process uses. A segment is stale if no process that
/// we can see maps it and nobody holds its lock file, which Fast DDS locks while the owner lives (also in
/// another container). Returns how many segments stay for their lock alone, which may be let go any moment: a
/// process that ends gives up its memory before its locks.
std::size_t remove_stale_shared_memory();

}  // namespace coppice
