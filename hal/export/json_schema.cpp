#include "hal/export/json_schema.hpp"

#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using Json = nlohmann::ordered_json;
using Kind = ColumnInfo::Kind;

Json schema_of(const ColumnInfo& column) {
  Json schema;
  switch (column.kind) {
    case Kind::truth: schema["type"] = "boolean"; break;
    case Kind::whole: schema["type"] = "integer"; break;
    case Kind::number: schema["type"] = "number"; break;
    case Kind::text: schema["type"] = "string"; break;
    case Kind::words:
      schema["type"] = "array";
      schema["items"] = {{"type", "string"}};
      break;
  }
  schema["description"] =
      column.unit.empty() ? column.meaning : column.meaning + " [" + column.unit + "]";
  return schema;
}

}  // namespace

std::string json_schema(const TopicInfo& topic) {
  Json properties = Json::object();
  for (const ColumnInfo* const column : topic.columns) {
    const std::size_t dot = column->path.find('.');
    if (dot == std::string::npos) {
      properties[column->path] = schema_of(*column);
      continue;
    }
    Json& group = properties[column->path.substr(0, dot)];
    group["type"] = "object";
    group["properties"][column->path.substr(dot + 1)] = schema_of(*column);
  }
  return Json{{"$schema", "http://json-schema.org/draft-07/schema#"},
              {"title", "cargobay." + std::string{topic.name}},
              {"description", topic.meaning},
              {"type", "object"},
              {"properties", std::move(properties)}}
      .dump();
}

}  // namespace cargobay::hal
