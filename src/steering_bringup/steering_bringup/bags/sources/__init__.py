"""Bags of any origin: their files, what is in them, and their messages in order of time."""

from steering_bringup.bags.sources.bag import EARLIEST, Bag, Message, open_bag
from steering_bringup.bags.sources.topics import TopicInfo

__all__ = ["EARLIEST", "Bag", "Message", "TopicInfo", "open_bag"]
