// A parameter that is a function, for functions that are not templates.
#pragma once

namespace cloudbake {

/// A callable without its type. It must outlive the reference.
template <class Signature>
class FunctionRef;
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  template <class Callable>
  FunctionRef(const Callable& callable)  // not explicit: a lambda is given as it is
      : callable_(&callable),
        call_([](const void* one, Arguments... arguments) -> Result { return (*static_cast<const Callable*>(one))(arguments...); }) {}
  Result operator()(Arguments... arguments) const { return call_(callable_, arguments...); }

 private:
  const void* callable_;
  Result (*call_)(const void*, Arguments...);
};

}  // namespace cloudbake
