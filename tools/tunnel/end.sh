#!/bin/sh
# One end of a WireGuard tunnel for a graph on two computers (docs/security.md). Run it as root on both.
#
#   end.sh up NAMESPACE OWN_ADDRESS OWN_PORT KEY_FILE PEER_ADDRESS PEER_PUBLIC_KEY PEER_ENDPOINT
#   end.sh down NAMESPACE
#
# The network namespace has its loopback and the tunnel, and nothing else. The encrypted datagrams travel in the namespace
# in which this is called. Without WireGuard in the system's kernel, wireguard-go does the same as a process.
set -eu

usage() {
    sed -n 's/^#   //p' "$0" >&2
    exit 2
}

link_of() { # names of links have 15 characters at most
    printf 'wg-%.12s' "$1"
}

up() {
    [ $# -eq 7 ] || usage
    link=$(link_of "$1")
    ip netns add "$1"
    ip link add "$link" type wireguard 2>/dev/null || LOG_LEVEL=error wireguard-go "$link" >/dev/null 2>&1
    wg set "$link" private-key "$4" listen-port "$3" \
        peer "$6" allowed-ips "$5/32" endpoint "$7" persistent-keepalive 25
    ip link set "$link" netns "$1"
    ip -n "$1" address add "$2/24" dev "$link"
    ip -n "$1" link set lo up
    ip -n "$1" link set "$link" up
}

down() {
    [ $# -eq 1 ] || usage
    ip -n "$1" link delete "$(link_of "$1")" # ends wireguard-go as well
    ip netns delete "$1"
}

action=${1:-}
[ $# -eq 0 ] || shift
case $action in
up | down) "$action" "$@" ;;
*) usage ;;
esac
