#!/usr/bin/env bash
# Says which of the programs and libraries were compiled without what ORACLEGS_HARDENING asks for; exit code 1.
#   packaging/check_hardening.sh FILE...
set -euo pipefail

weak=0
lacks() {
  echo "packaging/check_hardening.sh: $1 $2" >&2
  weak=1
}
for file in "$@"; do
  dynamic=$(readelf --wide --dynamic "$file")
  symbols=$(readelf --wide --dyn-syms "$file")
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<<"$dynamic" || lacks "$file" "binds symbols late (-Wl,-z,now)"
  grep -q GNU_RELRO <<<"$(readelf --wide --segments "$file")" || lacks "$file" "has tables that can be written (-Wl,-z,relro)"
  grep -q __stack_chk_fail <<<"$symbols" || lacks "$file" "does not look after its stack (-fstack-protector-strong)"
  grep -q _chk@ <<<"$symbols" || lacks "$file" "calls no checked function (-D_FORTIFY_SOURCE=2)"
done
exit $weak
