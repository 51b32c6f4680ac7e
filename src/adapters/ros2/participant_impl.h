// The interface of a middleware for Participant. participant.cpp implements it on DDS, helper_participant.cpp through a helper
// program. Contracts are those of participant.h.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "ros2/participant.h"

namespace culprit::ros2 {

class Reader::Impl {
 public:
  virtual ~Impl() = default;
  virtual const rtps::Guid& guid() const = 0;
};

class Writer::Impl {
 public:
  virtual ~Impl() = default;
  virtual const rtps::Guid& guid() const = 0;
  virtual std::optional<std::int64_t> write(rtps::ByteView payload,
                                            const rtps::SampleIdentity& related) = 0;
  virtual void forget_unacknowledged() = 0;
  virtual bool is_acknowledged() const = 0;
};

class Participant::Impl {
 public:
  virtual ~Impl() = default;

  virtual const rtps::Guid& guid() const = 0;
  virtual void leave() = 0;
  virtual void hold() = 0;
  virtual void release() = 0;
  virtual void begin_hurry() = 0;
  virtual void end_hurry() = 0;
  virtual void on_round(std::function<void()> on_round) = 0;

  virtual rtps::DatagramSources::Origin origin_of(const rtps::GuidPrefix& participant) const = 0;
  virtual void prove(const rtps::GuidPrefix& participant, int pid) = 0;
  virtual rtps::Origins& origins() = 0;
  virtual Time heard_last(const rtps::GuidPrefix& participant) const = 0;
  virtual Time own_came_through() const = 0;
  virtual void look_at_receivers(Time now) = 0;
  virtual Time receivers_attended() const = 0;
  virtual rtps::DatagramFilter::Refused refused() const = 0;
  virtual std::uint64_t dropped_here() const = 0;

  virtual Expected<std::unique_ptr<Reader>> create_reader(ReaderOptions options,
                                                          SampleCallback on_sample) = 0;
  virtual Expected<std::unique_ptr<Writer>> create_writer(WriterOptions options) = 0;
};

}  // namespace culprit::ros2
