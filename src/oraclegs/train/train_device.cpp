#include "oraclegs/train/train_device.h"

#include <type_traits>

#include "oraclegs/gaussians/selection.h"

namespace oraclegs {
namespace {

/// Replaces the rows of `to` by those of `from`, in the memory of `to` where that has room.
template <class T>
void StoreRows(const Buffer<T>& from, Buffer<T>* to) {
  *to = to->GrownTo(from.size(0));
  to->CopyFrom(from);
}

template <class T>
void KeepRowsOf(const std::vector<int64_t>& rows, Buffer<T>* buffer) {
  if (buffer->device().is_cpu()) {
    *buffer = PickedRows(*buffer, rows);
  } else {
    StoreRows(PickedRows(buffer->CopyOn(kCpu), rows), buffer);
  }
}

/// Calls f(buffer) for all parameters and moments, in one order.
template <class F>
void ForEachBuffer(TrainedModel* model, F&& f) {
  model->gaussians.ForEach([&](const char*, Buffer<float>& buffer) { f(buffer); });
  model->adam.ForEachMoment([&](const char*, const char*, auto& buffer) { f(buffer); });
}

}  // namespace

void OnHost(TrainedModel* model, const std::function<void(TrainedModel*)>& edit) {
  if (model->gaussians.device().is_cpu()) return edit(model);
  TrainedModel host = *model;
  ForEachBuffer(&host, [](auto& buffer) { buffer = buffer.CopyOn(kCpu); });
  edit(&host);
  std::vector<const void*> edited;
  ForEachBuffer(&host, [&](auto& buffer) { edited.push_back(&buffer); });
  size_t next = 0;
  ForEachBuffer(model, [&](auto& buffer) {
    StoreRows(*static_cast<const std::remove_reference_t<decltype(buffer)>*>(edited[next++]), &buffer);
  });
  model->adam.step = host.adam.step;
}

void KeepRows(const std::vector<int64_t>& rows, Gaussians* gaussians, Adam* adam) {
  gaussians->ForEach([&](const char*, Buffer<float>& buffer) { KeepRowsOf(rows, &buffer); });
  adam->ForEachMoment([&](const char*, const char*, auto& buffer) { KeepRowsOf(rows, &buffer); });
}

}  // namespace oraclegs
