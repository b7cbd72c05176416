// The command line of tree_broker.
#pragma once

#include <cstdint>

#include "runtime/process_options.h"

namespace coppice {

struct BrokerOptions {
  ProcessOptions process;
  std::uint64_t seed = 1;
};

/// `options` must outlive the parsing.
void add_broker_options(CLI::App& app, BrokerOptions& options);

}  // namespace coppice
