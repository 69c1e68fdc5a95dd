# SPDX-License-Identifier: Apache-2.0
import unittest

import numpy as np
from my_plugin import MyPluginTemplate


class MyPluginTest(unittest.TestCase):
    def test_covers_the_disc_once_with_faces_that_look_at_the_camera(self):
        disc = MyPluginTemplate(radius_m=0.1, rings=5, spokes=200).build(None)
        corners = disc.flat_px[disc.faces]
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        self.assertLess(turned.max(), 0.0)
        area_m2 = np.abs(turned).sum() / 2 * np.prod(disc.m_per_px)
        self.assertAlmostEqual(area_m2 / (np.pi * 0.1 ** 2), 1.0, places=3)

    def test_has_its_middle_in_that_of_the_texture_and_a_mask_around_it(self):
        disc = MyPluginTemplate(texture_px=101).build(None)
        np.testing.assert_allclose(disc.flat_px[0], [50, 50])
        self.assertTrue(disc.mask[50, 0] and disc.mask[0, 50] and not disc.mask[0, 0])
        self.assertEqual(disc.texture.shape, (101, 101))


if __name__ == "__main__":
    unittest.main()
