from setuptools import find_packages
from setuptools import setup

package_name = 'culprit_launch'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', ['launch/culprit.launch.py']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='The culprit developers',
    maintainer_email='maintainers@example.org',
    description="Launch actions: culprit beside a robot's nodes, and nodes that launch starts and"
                ' culprit heals.',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
)
