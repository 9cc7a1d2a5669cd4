#include "settings.h"

#include "nearest.h"

#include <XmlRpcValue.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <ros/console.h>
#include <ros/param.h>
#include <sstream>

namespace robot_cloth {
namespace {

using XmlRpc::XmlRpcValue;

const char *typeName(const XmlRpcValue &v)
{
  switch (v.getType()) {
  case XmlRpcValue::TypeBoolean:
    return "a bool";
  case XmlRpcValue::TypeInt:
    return "an int";
  case XmlRpcValue::TypeDouble:
    return "a double";
  case XmlRpcValue::TypeString:
    return "a string";
  case XmlRpcValue::TypeArray:
    return "a list";
  case XmlRpcValue::TypeStruct:
    return "a dictionary";
  default:
    return "something else";
  }
}

[[noreturn]] void wrongType(const string &name, const char *wanted, const XmlRpcValue &v)
{
  std::ostringstream text;
  text << "parameter " << name << " must be " << wanted << ", but it is " << typeName(v);
  if (v.getType() != XmlRpcValue::TypeStruct) {
    text << " (";
    v.write(text);
    text << ")";
  }
  throw StartError(text.str());
}

bool isNumber(const XmlRpcValue &v)
{
  return v.getType() == XmlRpcValue::TypeInt || v.getType() == XmlRpcValue::TypeDouble;
}

double number(const string &name, XmlRpcValue v)
{
  if (!isNumber(v)) wrongType(name, "a number", v);
  return v.getType() == XmlRpcValue::TypeInt ? int(v) : double(v);
}

// one overload per type of settings.inl; an int is a good double, nothing else converts
void read(const string &name, XmlRpcValue v, double &out) { out = number(name, v); }

void read(const string &name, XmlRpcValue v, int &out)
{
  if (v.getType() != XmlRpcValue::TypeInt) wrongType(name, "an int", v);
  out = v;
}

void read(const string &name, XmlRpcValue v, bool &out)
{
  if (v.getType() != XmlRpcValue::TypeBoolean) wrongType(name, "true or false", v);
  out = v;
}

void read(const string &name, XmlRpcValue v, string &out)
{
  if (v.getType() != XmlRpcValue::TypeString) wrongType(name, "a string", v);
  out = string(v);
}

void read(const string &name, XmlRpcValue v, std::vector<string> &out)
{
  if (v.getType() != XmlRpcValue::TypeArray) wrongType(name, "a list of strings", v);
  out.clear();
  for (int i = 0; i < v.size(); i++) {
    out.emplace_back();
    read(name + "[" + std::to_string(i) + "]", v[i], out.back());
  }
}

void read(const string &name, XmlRpcValue v, double (&out)[3])
{
  if (v.getType() != XmlRpcValue::TypeArray || v.size() != 3)
    wrongType(name, "a list of 3 numbers", v);
  for (int i = 0; i < 3; i++) out[i] = number(name, v[i]);
}

void check(const string &name, double value, const char *unit, double least, double most)
{
  if (value >= least && value <= most) return; // false for NaN
  std::ostringstream text;
  text << "parameter " << name << " is " << value << " " << unit << ", but must be in [" << least
       << ", " << most << "] " << unit;
  throw StartError(text.str());
}

void check(const string &name, int value, const char *unit, double least, double most)
{
  check(name, double(value), unit, least, most);
}

void check(const string &, bool, const char *, double, double) {}

void check(const string &name, const string &value, const char *choices, double, double)
{
  if (!std::strchr(choices, '|')) return; // the unit column names choices only where there are some
  std::istringstream list(choices);
  string choice;
  const char *best = nullptr;
  std::vector<string> all;
  while (std::getline(list, choice, '|')) {
    if (choice == value) return;
    all.push_back(choice);
  }
  for (const string &c : all) cloth_nearest(value.c_str(), c.c_str(), &best);
  throw StartError("parameter " + name + " is '" + value + "', but must be one of " + choices +
                   (best ? string("; did you mean '") + best + "'?" : ""));
}

std::vector<string> settingNames()
{
  return {
#define CLOTH_SETTING(type, member, name, value, unit, least, most, meaning) name,
#include "settings.inl"
  };
}

[[noreturn]] void unknownKey(const string &ns, const string &key, const std::vector<string> &known)
{
  const char *best = nullptr;
  for (const string &k : known) cloth_nearest(key.c_str(), k.c_str(), &best);
  throw StartError("parameter " + ns + "/" + key + " is not known" +
                   (best ? string("; did you mean ") + ns + "/" + best + "?" : ""));
}

// A dictionary of parameters as "a/b/c" -> value.
void flatten(const string &prefix, XmlRpcValue v, std::map<string, XmlRpcValue> &out)
{
  if (v.getType() != XmlRpcValue::TypeStruct) {
    out[prefix] = v;
    return;
  }
  for (auto &entry : v)
    flatten(prefix.empty() ? entry.first : prefix + "/" + entry.first, entry.second, out);
}

GripperSettings readGripper(const string &name, XmlRpcValue v)
{
  if (v.getType() != XmlRpcValue::TypeStruct) wrongType(name, "a dictionary", v);
  GripperSettings g;
  bool has_region = false, has_close = false, has_open = false, turned_open = false;
  XmlRpcValue region;
  std::map<string, std::function<void(const string &, XmlRpcValue)>> keys;
  keys["name"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.name); };
  keys["joint"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.joint); };
  keys["close_below"] = [&](const string &n, XmlRpcValue x) {
    read(n, x, g.close_below), has_close = true;
  };
  keys["open_above"] = [&](const string &n, XmlRpcValue x) {
    read(n, x, g.open_above), has_open = true;
  };
  // a joint that grows as the gripper closes: the same with the sign turned
  keys["close_above"] = [&](const string &n, XmlRpcValue x) {
    g.close_below = -number(n, x), g.sign = -1, has_close = true;
  };
  keys["open_below"] = [&](const string &n, XmlRpcValue x) {
    g.open_above = -number(n, x), turned_open = has_open = true;
  };
  keys["frame"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.frame); };
  keys["links"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.links); };
  keys["cloth"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.cloth); };
  keys["release"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.release); };
  keys["limit"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.limit); };
  keys["compliance"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.compliance); };
  keys["break_force"] = [&](const string &n, XmlRpcValue x) { read(n, x, g.break_force); };
  keys["region"] = [&](const string &n, XmlRpcValue x) {
    if (x.getType() != XmlRpcValue::TypeStruct) wrongType(n, "a dictionary {center, size}", x);
    for (auto &entry : x) {
      if (entry.first == "center")
        read(n + "/center", entry.second, g.region_center);
      else if (entry.first == "size")
        read(n + "/size", entry.second, g.region_size), has_region = true;
      else
        unknownKey(n, entry.first, {"center", "size"});
    }
  };
  std::vector<string> known;
  for (const auto &k : keys) known.push_back(k.first);
  for (auto &entry : v) {
    auto key = keys.find(entry.first);
    if (key == keys.end()) unknownKey(name, entry.first, known);
    key->second(name + "/" + entry.first, entry.second);
  }
  auto need = [&](bool there, const char *key) {
    if (!there) throw StartError("parameter " + name + "/" + key + " is missing");
  };
  need(!g.name.empty(), "name"), need(!g.joint.empty(), "joint"), need(!g.frame.empty(), "frame");
  need(has_close, "close_below"), need(has_open, "open_above"), need(has_region, "region/size");
  if (turned_open != (g.sign < 0))
    throw StartError("parameter " + name +
                     ": close_below goes with open_above, close_above with open_below");
  if (!(g.open_above > g.close_below))
    throw StartError("parameter " + name +
                     ": opening must be farther than closing, but it opens at " +
                     std::to_string(g.sign * g.open_above) + " and closes at " +
                     std::to_string(g.sign * g.close_below) + "; the gap is the hysteresis");
  for (double size : g.region_size) check(name + "/region/size", size, "m", 1e-6, 10);
  for (double x : g.region_center) check(name + "/region/center", x, "m", -10, 10);
  check(name + "/compliance", g.compliance, "m/N", 0, 1e6);
  check(name + "/break_force", g.break_force, "N", 0, 1e9);
  check(name + "/limit", g.limit, "1", 0, 1e9);
  return g;
}

// A scene parameter as the text that cloth_def_set() reads.
string asText(const string &name, XmlRpcValue v)
{
  switch (v.getType()) {
  case XmlRpcValue::TypeString:
    return v;
  case XmlRpcValue::TypeInt:
    return std::to_string(int(v));
  case XmlRpcValue::TypeDouble: {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", double(v));
    return text;
  }
  case XmlRpcValue::TypeBoolean: // YAML reads on and off as bool, as in effects: {wind: off}
    return bool(v) ? "true" : "false";
  case XmlRpcValue::TypeArray: {
    string text;
    for (int i = 0; i < v.size(); i++) {
      const string part = name + "[" + std::to_string(i) + "]";
      if (v[i].getType() == XmlRpcValue::TypeString)
        text += (i ? "," : "") + string(v[i]); // devices
      else {
        number(part, v[i]);
        text += (i ? " " : "") + asText(part, v[i]);
      }
    }
    return text;
  }
  default:
    wrongType(name, "a number, a string or a list", v);
  }
}

// The type that a parameter of params.inl must have; text that happens to read as a number is
// refused all the same: it is a quoting mistake.
void checkSceneType(const string &name, const cloth_param_info *info, XmlRpcValue v)
{
  switch (info->kind) {
  case cloth_param_info::CLOTH_IS_DOUBLE:
    if (v.getType() == XmlRpcValue::TypeString &&
        (string(info->name) == "time_budget" || string(info->name) == "accuracy"))
      break; // real_time; 1 %
    number(name, v);
    break;
  case cloth_param_info::CLOTH_IS_INT:
    if (v.getType() != XmlRpcValue::TypeInt) wrongType(name, "an int", v);
    break;
  case cloth_param_info::CLOTH_IS_VECTOR:
    if (v.getType() != XmlRpcValue::TypeArray || v.size() != 3)
      wrongType(name, "a list of 3 numbers", v);
    break;
  case cloth_param_info::CLOTH_IS_CHOICE:
    if (std::strcmp(info->choices, "false|true") == 0) {
      if (v.getType() != XmlRpcValue::TypeBoolean) wrongType(name, "true or false", v);
    } else if (v.getType() != XmlRpcValue::TypeString) {
      wrongType(name, "a string", v);
    }
    break;
  }
}

} // namespace

Settings readSettings(const ros::NodeHandle &priv)
{
  Settings s;
  const string ns = priv.getNamespace();
  XmlRpcValue all;
  std::map<string, XmlRpcValue> flat;
  if (priv.getParam(ns, all) && all.getType() == XmlRpcValue::TypeStruct) {
    for (auto &entry : all) {
      if (entry.first == "grippers") {
        if (entry.second.getType() != XmlRpcValue::TypeArray)
          wrongType(ns + "/grippers", "a list of dictionaries", entry.second);
        for (int i = 0; i < entry.second.size(); i++)
          s.grippers.push_back(
              readGripper(ns + "/grippers[" + std::to_string(i) + "]", entry.second[i]));
      } else if (entry.first == "params") {
        if (entry.second.getType() != XmlRpcValue::TypeStruct)
          wrongType(ns + "/params", "a dictionary of scene parameters", entry.second);
        std::map<string, XmlRpcValue> params;
        flatten("", entry.second, params);
        for (auto &p : params) {
          string key = p.first;
          const string name = ns + "/params/" + key;
          for (const cloth_param_info *i = cloth_param_table(); i->name; i++)
            if (key == i->name) checkSceneType(name, i, p.second);
          if (key.rfind("effects/", 0) == 0) key[7] = '.';
          string text = asText(name, p.second);
          for (char &c : text)
            if (key == "devices" && c == ' ') c = ','; // [0, 0] as well as [cpu, cpu]
          s.scene.emplace_back(key, text);
        }
      } else {
        flatten(entry.first, entry.second, flat);
      }
    }
  }
  for (size_t i = 0; i < s.grippers.size(); i++)
    for (size_t j = 0; j < i; j++)
      if (s.grippers[i].name == s.grippers[j].name) // it is the id of the grasps
        throw StartError("parameter " + ns + "/grippers: grippers " + std::to_string(j) + " and " +
                         std::to_string(i) + " are both named '" + s.grippers[i].name +
                         "'; rename one");
  const std::vector<string> known = settingNames();
  flat.erase("robot_description"); // a URDF of our own namespace
  for (auto &entry : flat)
    if (std::find(known.begin(), known.end(), entry.first) == known.end()) {
      for (const string &k : known)
        if (k.rfind(entry.first + "/", 0) == 0)
          wrongType(ns + "/" + entry.first, ("a dictionary with keys such as " + k).c_str(),
                    entry.second);
      std::vector<string> near = known;
      near.insert(near.end(), {"grippers", "params"});
      unknownKey(ns, entry.first, near);
    }
#define CLOTH_SETTING(type, member, name, value, unit, least, most, meaning)                       \
  if (flat.count(name)) {                                                                          \
    read(ns + "/" + name, flat[name], s.member);                                                   \
    check(ns + "/" + name, s.member, unit, least, most);                                           \
  }                                                                                                \
  ROS_INFO_STREAM("  ~" << name << " = " << std::boolalpha << s.member << " " << unit              \
                        << (flat.count(name) ? "" : " (default)"));
#include "settings.inl"
  if (!s.world_frame.empty() && s.world_frame[0] == '/')
    s.world_frame.erase(0, 1); // as tf1 wrote it
  if (s.world_frame.empty())
    throw StartError("parameter " + ns +
                     "/world_frame is empty: give it the tf frame that is the scene's, e.g. world");
  if (s.scene_file.empty())
    throw StartError("parameter " + ns +
                     "/scene is not set: give it the path of a scene file (YAML), such as "
                     "$(find robot_cloth)/config/scenes/towel_on_table.yaml");
  return s;
}

std::vector<string> applyParams(const Settings &settings, const string &ns, cloth_def *def)
{
  const cloth_params before = cloth_params_default();
  for (const auto &p : settings.scene) {
    cloth_error err = {};
    if (cloth_def_set(def, p.first.c_str(), p.second.c_str(), &err) != CLOTH_OK)
      throw StartError("parameter " + ns + "/params/" + p.first + ": " + err.text);
  }
  std::vector<string> lines;
  const cloth_params *now = cloth_def_params(def);
  for (const cloth_param_info *i = cloth_param_table(); i->name; i++) {
    const char *a = reinterpret_cast<const char *>(now) + i->offset;
    const char *b = reinterpret_cast<const char *>(&before) + i->offset;
    std::ostringstream line;
    line << i->name << " = ";
    size_t size = sizeof(double);
    const char *unit = i->unit;
    if (i->kind == cloth_param_info::CLOTH_IS_DOUBLE)
      line << *reinterpret_cast<const double *>(a);
    else if (i->kind == cloth_param_info::CLOTH_IS_VECTOR) {
      const double *v = reinterpret_cast<const double *>(a);
      line << v[0] << " " << v[1] << " " << v[2];
      size *= 3;
    } else {
      const int value = *reinterpret_cast<const int *>(a);
      size = sizeof(int);
      if (i->kind == cloth_param_info::CLOTH_IS_INT)
        line << value;
      else {
        std::istringstream choices(i->choices);
        string choice;
        for (int n = 0; n <= value; n++) std::getline(choices, choice, '|');
        line << choice;
        unit = i->choices;
      }
    }
    line << " " << unit << (std::memcmp(a, b, size) == 0 ? " (default)" : "");
    lines.push_back(line.str());
    ROS_INFO_STREAM("  ~params/" << lines.back());
  }
  return lines;
}

} // namespace robot_cloth
