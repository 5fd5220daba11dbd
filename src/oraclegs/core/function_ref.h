#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace oraclegs {

/// Something callable that somebody else owns: a parameter type for callbacks that are not kept beyond the call.
/// Unlike std::function it never allocates, whatever a lambda captures.
template <class Signature>
class FunctionRef;

template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  /// `callable` must live as long as this object is called.
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_object_v<std::remove_reference_t<F>> &&
           std::is_invocable_r_v<Result, F&, Arguments...>)
      FunctionRef(F&& callable)  // NOLINT: implicit, so that a lambda can be written where one is wanted
      // The lambda below gives the object its own type back, const or not.
      : callable_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))),
        call_([](void* target, Arguments... arguments) -> Result {
          return (*static_cast<std::remove_reference_t<F>*>(target))(std::forward<Arguments>(arguments)...);
        }) {}

  Result operator()(Arguments... arguments) const { return call_(callable_, std::forward<Arguments>(arguments)...); }

 private:
  void* callable_;
  Result (*call_)(void*, Arguments...);
};

}  // namespace oraclegs
