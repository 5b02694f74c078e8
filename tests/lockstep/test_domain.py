import socket

import pytest

from steering_lockstep.domain import DISCOVERY_PORT, PORTS_PER_DOMAIN, DomainError, claim_domain


def test_two_claims_never_meet():
    one = claim_domain()
    two = claim_domain()
    try:
        assert one.number != two.number
    finally:
        one.release()
        two.release()


def test_claim_of_a_domain_in_use_is_refused_and_free_again_after_release():
    claim = claim_domain()
    with pytest.raises(DomainError, match=str(claim.number)):
        claim_domain(claim.number)
    claim.release()
    claim_domain(claim.number).release()


def test_domain_with_a_listening_participant_is_passed_over():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as foreign:
        foreign.bind(("", DISCOVERY_PORT + PORTS_PER_DOMAIN * 90))
        with pytest.raises(DomainError):
            claim_domain(candidates=[90])
