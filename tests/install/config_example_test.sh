#!/usr/bin/env bash
# The example configuration and its man page know the keys that the command knows.
# usage: config_example_test.sh [COMMAND]; by itself build/release/cargobay
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
program=$(realpath "${1:-$root/build/release/cargobay}")
example=$root/examples/system/cargobay.toml
failed=0
complain() {
  echo "$*"
  failed=1
}

# The rows of the settings, and the names of the pins' keys in config.cpp: the first word in quotes
# of what makes a key.
mapfile -t keys < <({
  grep -ohE '\.(key|table) = "[a-z_0-9]+"' "$root/hal/config/setting_table.cpp"
  tr '\n' ' ' < "$root/hal/config/config.cpp" | grep -oE '(_key\(|table\(|\{)"[a-z_0-9]+"'
} | grep -oE '[a-z_0-9]+"$' | tr -d '"' | sort -u)
((${#keys[@]} >= 20)) || complain "found only ${#keys[@]} keys in hal/config"
for key in "${keys[@]}"; do
  grep -qE "^#?(\[([a-z_]+\.)?$key(\.[a-z_]+)?\]|$key = )" "$example" || complain "$example: no $key"
  grep -qwF -- "${key//_/\\_}" "$root/docs/man/cargobay.toml.5" ||
    grep -qwF -- "$key" "$root/docs/man/cargobay.toml.5" || complain "docs/man/cargobay.toml.5: no $key"
done

# With all settings active, the command goes on to the port, which does not exist.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
sed -E 's/^#(\[|[a-z_0-9]+ = )/\1/' "$example" > "$folder/all.toml"
for file in "$example" "$folder/all.toml"; do
  message=$("$program" sensors --once --port "$folder/none" --config "$file" 2>&1) && complain "opened no port"
  [[ $message == *"$folder/none"* && $message != *toml* ]] || complain "$file: $message"
done

((failed)) || echo "configuration: ${#keys[@]} keys, all of them in the example and the man page"
exit "$failed"
