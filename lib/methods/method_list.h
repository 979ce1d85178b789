// Lists of methods, and the one way to find a method in them.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "lib/methods/method.h"
#include "lib/methods/method_text.h"

namespace spool {

template <class Function>
struct MethodList {
  std::string kind;                       // "sampler", "filter"
  std::vector<Method<Function>> methods;  // in the order in which people should read them
  std::string other_kind = {};            // "filter" of samplers, for those who mix them up
  std::vector<std::string> other_names = {};

  auto begin() const { return methods.begin(); }
  auto end() const { return methods.end(); }
  std::size_t size() const { return methods.size(); }
};

// The method of a name; null when there is none.
template <class Function>
const Method<Function>* find_method(const MethodList<Function>& list, std::string_view name) {
  for (const Method<Function>& method : list) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

// Error kUsage, with the nearest known name.
template <class Function>
Result<const Method<Function>*> known_method(const MethodList<Function>& list,
                                             std::string_view name) {
  if (const Method<Function>* method = find_method(list, name)) return method;
  if (std::ranges::find(list.other_names, name) != list.other_names.end()) {
    return fail(ErrorCode::kUsage, "'{}' is a {}, not a {}: give it to the {}s", name,
                list.other_kind, list.kind, list.other_kind);
  }
  return fail(ErrorCode::kUsage, "{}",
              unknown_name(list.kind, name, names_of(list),
                           fmt::format(": see spool list {}s", list.kind)));
}

// A label that is the name of a method would say that it is that one.
template <class Function>
Result<void> check_own_label(const MethodList<Function>& list, const MethodChoice& choice) {
  if (choice.own_label.empty()) return {};
  SPOOL_TRY(check_label(choice));
  if (find_method(list, choice.own_label) == nullptr) return {};
  return fail(ErrorCode::kUsage, "label '{}': is the name of a {}: choose another",
              choice.own_label, list.kind);
}

// Gives commands without an own label a short one, "denoise{timeout=9}"; a name that is another
// method's gets a number: "denoise_2". The same choices get the same labels again.
template <class Function>
void label_commands(const MethodList<Function>& list, std::vector<MethodChoice>& choices) {
  std::vector<std::string> taken = names_of(list);
  for (const MethodChoice& choice : choices)
    taken.push_back(choice.label());
  for (MethodChoice& choice : choices) {
    const Method<Function>* method = find_method(list, choice.name);
    if (!choice.own_label.empty() || method == nullptr || method->argument != "COMMAND") continue;
    MethodChoice named = {command_name(choice.preset), "", choice.set};
    for (int n = 2; std::ranges::find(taken, named.label()) != taken.end(); ++n)
      named.name = fmt::format("{}_{}", command_name(choice.preset), n);
    taken.push_back(choice.own_label = named.label());
  }
}

// Reads a method as method_text.h says; error kUsage when there is none of that name. Whether it
// has its argument, preset and options is found when it is made.
template <class Function>
Result<MethodChoice> choose_method(const MethodList<Function>& list, std::string_view text) {
  std::vector<std::string> takes_argument;
  for (const Method<Function>& method : list) {
    if (!method.argument.empty()) takes_argument.push_back(method.name);
  }
  SPOOL_ASSIGN(MethodChoice choice, parse_method(text, takes_argument));
  SPOOL_TRY(known_method(list, choice.name));
  SPOOL_TRY(check_own_label(list, choice));
  return choice;
}

// The method of a choice, of which what it runs may be missing: enough for results that are there.
// Errors kUsage, with the nearest known name, when there is no such method, preset or option.
template <class Function>
Result<Ready<Function>> describe_method(const MethodList<Function>& list,
                                        const MethodChoice& choice) {
  SPOOL_ASSIGN(const Method<Function>* method, known_method(list, choice.name));
  return make_ready(list.kind, *method, choice.preset, choice.set);
}

// The same, ready to run; kUsage, too, when something that it runs is missing.
template <class Function>
Result<Ready<Function>> make_method(const MethodList<Function>& list, const MethodChoice& choice) {
  SPOOL_ASSIGN(Ready<Function> ready, describe_method(list, choice));
  if (!ready.installed) return ready;
  if (const auto installed = ready.installed(); !installed) {
    return fail(installed.error().code, "{} {}: {}", list.kind, choice.name,
                installed.error().message);
  }
  return ready;
}

}  // namespace spool
