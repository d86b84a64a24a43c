#!/bin/sh
# A tunnel between two new namespaces of this computer, 10.81.0.1 and 10.81.0.2, with new keys that nobody keeps.
#
#   pair.sh up NAMESPACE_A NAMESPACE_B [PORT_A PORT_B]
#   pair.sh down NAMESPACE_A NAMESPACE_B
set -eu
here=$(dirname "$0")
action=${1:-} a=${2:-} b=${3:-} port_a=${4:-51820} port_b=${5:-51821}
if [ -z "$b" ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
if [ "$action" = down ]; then
    "$here/end.sh" down "$a"
    exec "$here/end.sh" down "$b"
fi
umask 077
keys=$(mktemp -d)
trap 'rm -rf "$keys"' EXIT
wg genkey >"$keys/a"
wg genkey >"$keys/b"
"$here/end.sh" up "$a" 10.81.0.1 "$port_a" "$keys/a" 10.81.0.2 "$(wg pubkey <"$keys/b")" "127.0.0.1:$port_b"
"$here/end.sh" up "$b" 10.81.0.2 "$port_b" "$keys/b" 10.81.0.1 "$(wg pubkey <"$keys/a")" "127.0.0.1:$port_a"
