// What a process keeps, and whoever takes its place would find again.
#pragma once

#include <utility>

#include "messages/keep.h"

namespace coppice {

template <class Chooser>
struct Kept {
  explicit Kept(Chooser chooser = Chooser()) : keeper(std::move(chooser), &store) {}
  Kept(const Kept&) = delete;
  KeptInMemory store;
  Keeper<Chooser, KeptInMemory> keeper;
};

}  // namespace coppice
