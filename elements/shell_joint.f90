module shell_joint
  !! Rotational spring along the common edge of two shells that meet with or without an angle. With the outward conormal
  !! derivatives a_A, a_B of the position on both sides and the derivative t along the edge (all per length of the start),
  !!
  !!   N_A = a_A x t,   N_B = - a_B x t,   m = N/|N|,   s_A = t/|t| x m_A
  !!   cos phi = m_A . m_B,   sin phi = - m_B . s_A,      phi_0 at the start
  !!   W = int c (1 - cos(phi - phi_0)) dl
  !!
  !! which is c/2 (phi - phi_0)^2 for small changes and right for any rotation (Herrema and others 2019 penalise the same
  !! two components). With M = N/|N|^2, p = |t|, q_A = a_A . t/p, q_B alike,
  !!
  !!   d phi   = - p M_A . d a_A - p M_B . d a_B + (q_A M_A + q_B M_B) . d t
  !!   d M     = (d N - 2 M (N . d N))/|N|^2,   d p = t . d t/p,   d q = (d a . t + a . d t)/p - q d p/p
  !!
  !! The linear form takes d phi at the start and W = int c/2 (d phi)^2 dl.
  use kinds, only: wp
  use status_codes, only: ok, singular_map
  implicit none (type, external)
  private
  public :: joint_angle, joint_force

contains

  pure subroutine joint_angle(v, cosine, sine, status)
    real(wp), intent(in) :: v(3,3)          !! a_A, a_B, t
    real(wp), intent(out) :: cosine, sine   !! of phi
    integer, intent(out) :: status          !! ok, singular_map
    real(wp) :: ma(3), mb(3), lengths

    ma = cross(v(:,1), v(:,3))
    mb = -cross(v(:,2), v(:,3))
    lengths = norm2(ma)*norm2(mb)
    cosine = 1
    sine = 0
    status = singular_map
    if (.not. lengths > 0) return
    status = ok
    cosine = dot_product(ma, mb)/lengths
    sine = -dot_product(mb, cross(v(:,3), ma))/(lengths*norm2(v(:,3)))
  end subroutine joint_angle

  pure subroutine joint_force(dshp, start, length, cos_0, sin_0, stiffness, is_linear, ue, fe, ke, energy, status)
    real(wp), intent(in) :: dshp(:,:,:)     !! derivatives along the conormals of A and B and along the edge (3,nen,ng)
    real(wp), intent(in) :: start(:,:,:)    !! a_A, a_B, t at the start (3,3,ng)
    real(wp), intent(in) :: length(:)       !! of the points (ng) [length]
    real(wp), intent(in) :: cos_0(:), sin_0(:)  !! of phi_0 (ng)
    real(wp), intent(in) :: stiffness       !! c, moment per length and angle [force]
    logical, intent(in) :: is_linear        !! small rotations
    real(wp), intent(in) :: ue(:,:)         !! displacements (3,nen) [length]
    real(wp), intent(out) :: fe(:,:)        !! internal force (3,nen) [force]
    real(wp), intent(inout) :: ke(:,:,:,:)  !! df/du (3,nen,3,nen), blocks a >= b; size 0: not wanted
    real(wp), intent(out) :: energy         !! [force length]
    integer, intent(out) :: status          !! ok, singular_map
    real(wp) :: v(3,3), dv(3,3), slope(9), hessian(9,9), c, s, turn, torque, spring
    integer :: a, b, g, i, k, q, r

    fe = 0
    ke = 0
    energy = 0
    status = ok
    do g = 1, size(length)
      dv = matmul(ue, transpose(dshp(:,:,g)))
      v = start(:,:,g)
      if (.not. is_linear) v = v + dv
      call joint_angle(v, c, s, status)
      if (status /= ok) return
      call angle_derivatives(v, slope, hessian)
      if (is_linear) then
        turn = dot_product(slope, reshape(dv, [9]))
        energy = energy + length(g)*stiffness*turn**2/2
        torque = length(g)*stiffness*turn
        spring = length(g)*stiffness
        hessian = 0
      else
        energy = energy + length(g)*stiffness*(1 - c*cos_0(g) - s*sin_0(g))
        torque = length(g)*stiffness*(s*cos_0(g) - c*sin_0(g))
        spring = length(g)*stiffness*(c*cos_0(g) + s*sin_0(g))
      end if
      do a = 1, size(ue, 2)
        do q = 1, 3
          fe(:,a) = fe(:,a) + torque*dshp(q,a,g)*slope(3*q - 2:3*q)
        end do
      end do
      if (size(ke) == 0) cycle
      do k = 1, 9
        hessian(:,k) = torque*hessian(:,k) + spring*slope*slope(k)
      end do
      do b = 1, size(ue, 2)
        do r = 1, 3
          do k = 1, 3
            do a = b, size(ue, 2)
              do q = 1, 3
                do i = 1, 3
                  ke(i,a,k,b) = ke(i,a,k,b) + dshp(q,a,g)*hessian(3*q - 3 + i,3*r - 3 + k)*dshp(r,b,g)
                end do
              end do
            end do
          end do
        end do
      end do
    end do
  end subroutine joint_force

  pure subroutine angle_derivatives(v, slope, hessian)
    !! First and second derivatives of phi with respect to a_A, a_B, t.
    real(wp), intent(in) :: v(3,3)          !! a_A, a_B, t
    real(wp), intent(out) :: slope(9), hessian(9,9)
    real(wp) :: n(3,2), m(3,2), dn(3,2), dm(3,2), nn(2), p, q(2), dp, dq(2), d(3,3)
    integer :: k, side

    p = norm2(v(:,3))
    n(:,1) = cross(v(:,1), v(:,3))
    n(:,2) = -cross(v(:,2), v(:,3))
    do side = 1, 2
      nn(side) = dot_product(n(:,side), n(:,side))
      m(:,side) = n(:,side)/nn(side)
      q(side) = dot_product(v(:,side), v(:,3))/p
      slope(3*side - 2:3*side) = -p*m(:,side)
    end do
    slope(7:9) = q(1)*m(:,1) + q(2)*m(:,2)
    do k = 1, 9
      d = 0
      d(mod(k - 1, 3) + 1,(k + 2)/3) = 1
      dn(:,1) = cross(d(:,1), v(:,3)) + cross(v(:,1), d(:,3))
      dn(:,2) = -cross(d(:,2), v(:,3)) - cross(v(:,2), d(:,3))
      dp = dot_product(v(:,3), d(:,3))/p
      do side = 1, 2
        dm(:,side) = (dn(:,side) - 2*m(:,side)*dot_product(n(:,side), dn(:,side)))/nn(side)
        dq(side) = (dot_product(d(:,side), v(:,3)) + dot_product(v(:,side), d(:,3)) - q(side)*dp)/p
        hessian(3*side - 2:3*side,k) = -dp*m(:,side) - p*dm(:,side)
      end do
      hessian(7:9,k) = dq(1)*m(:,1) + q(1)*dm(:,1) + dq(2)*m(:,2) + q(2)*dm(:,2)
    end do
  end subroutine angle_derivatives

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)      !! vectors
    real(wp) :: c(3)                        !! a x b

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module shell_joint
