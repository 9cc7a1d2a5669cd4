// What callbacks leave for the simulation thread. Bounded: when it is full the oldest goes, and
// that is counted and reported in /diagnostics.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>

namespace robot_cloth {

template <class T> class Mailbox {
public:
  explicit Mailbox(size_t capacity) : capacity_(capacity) {}

  void put(T item)
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (items_.size() == capacity_) items_.pop_front(), lost_++;
    items_.push_back(std::move(item));
  }

  /// Everything since the last call, oldest first.
  std::deque<T> take()
  {
    std::deque<T> out;
    std::lock_guard<std::mutex> lock(mutex_);
    out.swap(items_);
    return out;
  }

  uint64_t lost() const
  {
    std::lock_guard<std::mutex> lock(mutex_);
    return lost_;
  }

private:
  const size_t capacity_;
  mutable std::mutex mutex_;
  std::deque<T> items_;
  uint64_t lost_ = 0;
};

} // namespace robot_cloth
